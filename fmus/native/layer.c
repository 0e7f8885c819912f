/*
FMI 2.0 for co-simulation around one part.

table.h says what the part has: its variables in the order of their value references (inputs,
parameters, outputs), the words for the causes of failures, and how large the records are.
The three functions of the part come as object code (code.py). This file does what
fmus/slave.py does for the same part with Python in it, call by call and word by word.

A unit is one block of memory and nothing is shared between units. All that changes in a run
is the `Core`, plain numbers, so an FMU state is a copy of it.
*/
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "table.h"

#define VARIABLES (INPUTS + PARAMETERS + OUTPUTS)
#define LONGEST 512

int part_initial(const double *params, const double *input, double time, double *state);
int part_advance(const double *params, const double *state, const double *input, double time,
                 double step, double *after);
int part_observe(const double *params, const double *state, const double *input, double time,
                 double *output);

typedef struct {
    double values[VARIABLES];
    double params[PARAMETERS];
    double state[STATES];
    double time;
    int tuned, begun, running;  /* parameters taken over; a state to step from; in step mode */
} Core;

/* An FMU state as bytes: read back by the same build alone. */
typedef struct {
    char guid[sizeof GUID];
    Core core;
} Packed;

typedef struct {
    Core core;
    int stale;        /* the outputs do not belong to state and inputs */
    double reached;   /* end of the last step that went well */
    int logging;
    int errors;       /* whether the category of errors is wanted */
    const fmi2CallbackFunctions *host;
    char name[];
} Unit;

/* ---- messages ---- */

static void say(Unit *unit, fmi2Status status, const char *words)
{
    if (unit->logging && unit->errors && unit->host->logger)
        unit->host->logger(unit->host->componentEnvironment, unit->name, status, "logStatusError",
                           words);
}

static void report(Unit *unit, const char *call, const char *cause)
{
    char words[LONGEST];
    snprintf(words, sizeof words, "%s: %s at t = %g s: %s", unit->name, call, unit->core.time,
             cause);
    say(unit, fmi2Error, words);
}

static fmi2Status refused(Unit *unit, const char *words)
{
    say(unit, fmi2Error, words);
    return fmi2Error;
}

static const char *cause_of(int number)
{
    int known = number > 0 && number < (int)(sizeof causes / sizeof *causes);
    return known ? causes[number] : "unknown cause";
}

/* A number as Python writes it where it is none. */
static const char *special(double value)
{
    if (isnan(value))
        return "nan";
    return value > 0 ? "inf" : "-inf";
}

/* ---- the part ---- */

static const double *inputs(const Unit *unit) { return unit->core.values; }

static void start(Unit *unit)
{
    memset(&unit->core, 0, sizeof unit->core);
    for (int k = 0; k < VARIABLES; k++)
        unit->core.values[k] = variables[k].start;
    unit->stale = 1;
    unit->reached = NAN;
}

/* Parameters as they are now, within their bounds; `cause` says which is not. */
static int tuned(Unit *unit, char *cause)
{
    const double *values = unit->core.values + INPUTS;
    for (int k = 0; k < PARAMETERS; k++) {
        const Variable *v = &variables[INPUTS + k];
        if (isfinite(values[k]) && values[k] >= v->least && values[k] <= v->most)
            continue;
        if (isfinite(values[k]))
            snprintf(cause, LONGEST, "%s = %g is outside %s", v->name, values[k], v->bounds);
        else
            snprintf(cause, LONGEST, "%s = %s is outside %s", v->name, special(values[k]),
                     v->bounds);
        return 0;
    }
    memcpy(unit->core.params, values, sizeof unit->core.params);
    unit->core.tuned = 1;
    return 1;
}

static int initialised(Unit *unit, char *cause)
{
    double state[STATES];
    if (!tuned(unit, cause))
        return 0;
    int number = part_initial(unit->core.params, inputs(unit), unit->core.time, state);
    if (number) {
        snprintf(cause, LONGEST, "%s", cause_of(number));
        return 0;
    }
    memcpy(unit->core.state, state, sizeof state);
    unit->core.begun = 1;
    return 1;
}

static int refreshed(Unit *unit, char *cause)
{
    double output[OUTPUTS];
    int number = part_observe(unit->core.params, unit->core.state, inputs(unit), unit->core.time,
                              output);
    if (number) {
        snprintf(cause, LONGEST, "%s", cause_of(number));
        return 0;
    }
    memcpy(unit->core.values + INPUTS + PARAMETERS, output, sizeof output);
    unit->stale = 0;
    return 1;
}

/* Bring the outputs up to date; a fault reads as NaN. */
static void observe(Unit *unit)
{
    char cause[LONGEST];
    if ((unit->core.running || initialised(unit, cause)) && refreshed(unit, cause))
        return;
    report(unit, "output", cause);
    for (int k = INPUTS + PARAMETERS; k < VARIABLES; k++)
        unit->core.values[k] = NAN;
}

/* Take over parameters set in mid-run; a bad one is refused and the old ones stay. */
static void retune(Unit *unit)
{
    char cause[LONGEST];
    if (tuned(unit, cause))
        return;
    memcpy(unit->core.values + INPUTS, unit->core.params, sizeof unit->core.params);
    report(unit, "parameter", cause);
}

/* Whether all inputs are numbers, and small enough to add. */
static int sound(const Unit *unit, char *cause)
{
    const double *values = inputs(unit);
    double sum = 0.0;
    for (int k = 0; k < INPUTS; k++)
        sum += values[k];
    if (isfinite(sum))
        return 1;
    snprintf(cause, LONGEST, "inputs are too large to add");
    for (int k = 0; k < INPUTS; k++)
        if (!isfinite(values[k])) {
            snprintf(cause, LONGEST, "input %s is %s", variables[k].name, special(values[k]));
            break;
        }
    return 0;
}

/* Largest of some value references, or -1; refused if it is none of a variable. */
static int known(Unit *unit, const fmi2ValueReference vr[], size_t count, long *largest)
{
    *largest = -1;
    for (size_t k = 0; k < count; k++) {
        if (vr[k] >= VARIABLES) {
            char words[LONGEST];
            snprintf(words, sizeof words, "%s: no variable has the value reference %u", unit->name,
                     vr[k]);
            say(unit, fmi2Error, words);
            return 0;
        }
        if ((long)vr[k] > *largest)
            *largest = (long)vr[k];
    }
    return 1;
}

static void changed(Unit *unit, long largest)
{
    unit->stale = 1;
    if (unit->core.running && largest >= INPUTS)
        retune(unit);
}

/* ---- FMI: creation, messages ---- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *host,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources, (void)visible;
    if (!name || !guid || !host)
        return NULL;
    size_t length = strlen(name) + 1;
    Unit *unit = calloc(1, sizeof *unit + length);
    if (!unit)
        return NULL;
    unit->host = host;
    unit->logging = logging;
    unit->errors = 1;
    memcpy(unit->name, name, length);
    for (char *c = unit->name; *c; c++)
        if (*c == '%')
            *c = '_'; /* hosts pass messages to printf */
    start(unit);
    if (type == fmi2CoSimulation && strcmp(guid, GUID) == 0)
        return unit;
    say(unit, fmi2Error,
        type == fmi2CoSimulation ? "the GUID is not that of this library: unpack the FMU again"
                                 : "this part is for co-simulation only");
    free(unit);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean logging, size_t count,
                               const fmi2String categories[])
{
    Unit *unit = c;
    unit->logging = logging;
    unit->errors = count == 0;
    for (size_t k = 0; k < count; k++)
        if (categories[k] && strcmp(categories[k], "logStatusError") == 0)
            unit->errors = 1;
    return fmi2OK;
}

/* ---- FMI: life ---- */

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance,
                               fmi2Real time, fmi2Boolean with_stop, fmi2Real stop)
{
    (void)with_tolerance, (void)tolerance, (void)with_stop, (void)stop;
    ((Unit *)c)->core.time = time;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Unit *unit = c;
    char cause[LONGEST];
    if (!initialised(unit, cause) || !refreshed(unit, cause)) {
        report(unit, "initialisation", cause);
        return fmi2Error;
    }
    unit->core.running = 1;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    start(c);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean keep)
{
    (void)keep;
    Unit *unit = c;
    Core *core = &unit->core;
    char cause[LONGEST];
    double after[STATES];
    int well = sound(unit, cause);
    if (well) {
        core->time = time;
        int number = -1;
        if (core->begun)
            number = part_advance(core->params, core->state, inputs(unit), time, step, after);
        well = number == 0;
        if (!well)
            snprintf(cause, LONGEST, "%s",
                     core->begun ? cause_of(number) : "the unit is not initialised");
    }
    if (!well) {
        report(unit, "step", cause);
        unit->reached = time;
        return fmi2Discard;
    }
    memcpy(core->state, after, sizeof after);
    core->time = unit->reached = time + step;
    unit->stale = 1;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return refused(c, "a step cannot be cancelled: it ends before the call returns");
}

/* ---- FMI: variables ---- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[])
{
    Unit *unit = c;
    long largest;
    if (!known(unit, vr, count, &largest))
        return fmi2Error;
    if (unit->stale && largest >= INPUTS + PARAMETERS)
        observe(unit);
    for (size_t k = 0; k < count; k++)
        value[k] = unit->core.values[vr[k]];
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[])
{
    Unit *unit = c;
    long largest;
    if (!known(unit, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++)
        unit->core.values[vr[k]] = value[k];
    changed(unit, largest);
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Integer value[])
{
    Unit *unit = c;
    long largest;
    if (!known(unit, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++) {
        double number = unit->core.values[vr[k]];
        if (!(fabs(number) <= 2147483647.0))
            return refused(unit, "the value of this variable is no integer");
        value[k] = (fmi2Integer)number;
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[])
{
    Unit *unit = c;
    long largest;
    if (!known(unit, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++)
        unit->core.values[vr[k]] = value[k];
    changed(unit, largest);
    return fmi2OK;
}

static fmi2Status none(fmi2Component c, size_t count, const char *words)
{
    return count ? refused(c, words) : fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no Boolean variables");
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no Boolean variables");
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no String variables");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no String variables");
}

/* ---- FMI: states ---- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Unit *unit = c;
    if (!*state)
        *state = malloc(sizeof(Core));
    if (!*state)
        return refused(unit, "no memory for a state");
    memcpy(*state, &unit->core, sizeof(Core));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Unit *unit = c;
    if (!state)
        return refused(unit, "there is no state to set");
    memcpy(&unit->core, state, sizeof(Core));
    unit->stale = 1;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Packed);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size)
{
    static const char guid[] = GUID;
    if (!state || size < sizeof(Packed))
        return refused(c, "the buffer is too small for a state");
    memset(bytes, 0, sizeof(Packed));
    memcpy(bytes + offsetof(Packed, guid), guid, sizeof guid);
    memcpy(bytes + offsetof(Packed, core), state, sizeof(Core));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    if (size != sizeof(Packed) || memcmp(bytes, GUID, sizeof GUID) != 0)
        return refused(c, "these bytes are no state of this build of the part");
    if (!*state)
        *state = malloc(sizeof(Core));
    if (!*state)
        return refused(c, "no memory for a state");
    memcpy(*state, bytes + offsetof(Packed, core), sizeof(Core));
    return fmi2OK;
}

/* ---- FMI: what the parts do not offer ---- */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t some, const fmi2ValueReference knowns[],
                                        size_t others, const fmi2Real seed[], fmi2Real value[])
{
    (void)unknowns, (void)some, (void)knowns, (void)others, (void)seed, (void)value;
    return refused(c, "directional derivatives are not offered: ports carry them as variables");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                       size_t count, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    (void)vr, (void)count, (void)order, (void)value;
    return refused(c, "input derivatives are not offered: ports carry them as variables");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[],
                                        fmi2Real value[])
{
    (void)vr, (void)count, (void)order, (void)value;
    return refused(c, "output derivatives are not offered: ports carry them as variables");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime)
        return refused(c, "the one real status is the last successful time");
    *value = ((Unit *)c)->reached;
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return refused(c, "steps are synchronous: there is no pending status");
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return refused(c, "there is no integer status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)kind, (void)value;
    return refused(c, "a step never terminates the simulation");
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return refused(c, "steps are synchronous: there is no pending status");
}
