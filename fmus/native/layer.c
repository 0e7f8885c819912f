/*
FMI 2.0 for co-simulation around one part.

table.h says what the part has: its header, its variables in the order of their value references
(inputs, parameters, outputs) and how large the records are. The three functions of the part are
translated from its physics. This file does what fmus/slave.py does for the same part with Python
in it, call by call and word by word.

An instance is one block of memory and nothing is shared between instances. All that changes in a
run is the `Core`, plain numbers, so an FMU state is a copy of it.
*/
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2.h"
#include "table.h"

#define VARIABLES (INPUTS + PARAMETERS + OUTPUTS)
#define LONGEST 512

typedef struct {
    double values[VARIABLES];
    Params params;
    State state;
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
    int logging;      /* whether anything is to be logged */
    int errors;       /* whether the category of errors is wanted */
    const fmi2CallbackFunctions *host;
    char name[];
} Instance;

/* ---- messages ---- */

static void say(Instance *self, fmi2Status status, const char *words)
{
    if (self->logging && self->errors && self->host->logger)
        self->host->logger(self->host->componentEnvironment, self->name, status, "logStatusError",
                           words);
}

static void report(Instance *self, const char *call, const char *cause)
{
    char words[2 * LONGEST];
    snprintf(words, sizeof words, "%s: %s at t = %g s: %s", self->name, call, self->core.time,
             cause);
    say(self, fmi2Error, words);
}

static fmi2Status refused(Instance *self, const char *words)
{
    say(self, fmi2Error, words);
    return fmi2Error;
}

/* A number as Python writes it where it is none. */
static const char *special(double value)
{
    if (isnan(value))
        return "nan";
    return value > 0 ? "inf" : "-inf";
}

/* ---- the part: each changes the core or returns the cause why not ---- */

static Input input_of(const Core *core)
{
    Input input;
    memset(&input, 0, sizeof input);
    memcpy(&input, core->values, INPUTS * sizeof(double));
    return input;
}

static const char *initial(Core *core)
{
    Fault fault;
    const Input input = input_of(core);
    if (MARK(&fault))
        return fault.cause;
    const State state = PART_INITIAL(&fault, &core->params, &input, core->time);
    core->state = state;
    return NULL;
}

static const char *advance(Core *core, double time, double step)
{
    Fault fault;
    const Input input = input_of(core);
    if (MARK(&fault))
        return fault.cause;
    const State state = PART_ADVANCE(&fault, &core->params, &core->state, &input, time, step);
    core->state = state;
    return NULL;
}

static const char *outputs(Core *core)
{
    Fault fault;
    const Input input = input_of(core);
    if (MARK(&fault))
        return fault.cause;
    const Output output = PART_OBSERVE(&fault, &core->params, &core->state, &input, core->time);
    memcpy(core->values + INPUTS + PARAMETERS, &output, sizeof output);
    return NULL;
}

/* ---- what an instance does with it ---- */

static void start(Instance *self)
{
    memset(&self->core, 0, sizeof self->core);
    for (int k = 0; k < VARIABLES; k++)
        self->core.values[k] = variables[k].start;
    self->stale = 1;
    self->reached = NAN;
}

/* Parameters as they are now, within their bounds; `cause` says which is not. */
static int tuned(Instance *self, char *cause)
{
    const double *values = self->core.values + INPUTS;
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
    memcpy(&self->core.params, values, sizeof self->core.params);
    self->core.tuned = 1;
    return 1;
}

static int initialised(Instance *self, char *cause)
{
    if (!tuned(self, cause))
        return 0;
    const char *words = initial(&self->core);
    if (words) {
        snprintf(cause, LONGEST, "%s", words);
        return 0;
    }
    self->core.begun = 1;
    return 1;
}

static int refreshed(Instance *self, char *cause)
{
    const char *words = outputs(&self->core);
    if (words) {
        snprintf(cause, LONGEST, "%s", words);
        return 0;
    }
    self->stale = 0;
    return 1;
}

/* Bring the outputs up to date; a fault reads as NaN. */
static void observe(Instance *self)
{
    char cause[LONGEST];
    if ((self->core.running || initialised(self, cause)) && refreshed(self, cause))
        return;
    report(self, "output", cause);
    for (int k = INPUTS + PARAMETERS; k < VARIABLES; k++)
        self->core.values[k] = NAN;
}

/* Take over parameters set in mid-run; a bad one is refused and the old ones stay. */
static void retune(Instance *self)
{
    char cause[LONGEST];
    if (tuned(self, cause))
        return;
    memcpy(self->core.values + INPUTS, &self->core.params, sizeof self->core.params);
    report(self, "parameter", cause);
}

/* Whether all inputs are numbers, and small enough to add. */
static int sound(const Instance *self, char *cause)
{
    const double *values = self->core.values;
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
static int known(Instance *self, const fmi2ValueReference vr[], size_t count, long *largest)
{
    *largest = -1;
    for (size_t k = 0; k < count; k++) {
        if (vr[k] >= VARIABLES) {
            char words[LONGEST];
            snprintf(words, sizeof words, "%s: no variable has the value reference %u", self->name,
                     vr[k]);
            say(self, fmi2Error, words);
            return 0;
        }
        if ((long)vr[k] > *largest)
            *largest = (long)vr[k];
    }
    return 1;
}

static void changed(Instance *self, long largest)
{
    self->stale = 1;
    if (self->core.running && largest >= INPUTS)
        retune(self);
}

/* ---- FMI: creation, messages ---- */

FMI2_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void) { return fmi2TypesPlatform; }

FMI2_EXPORT const char *FMI2(fmi2GetVersion)(void) { return fmi2Version; }

FMI2_EXPORT fmi2Component FMI2(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *host,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources, (void)visible;
    if (!name || !guid || !host)
        return NULL;
    size_t length = strlen(name) + 1;
    Instance *self = calloc(1, sizeof *self + length);
    if (!self)
        return NULL;
    self->host = host;
    self->logging = logging;
    self->errors = 1;
    memcpy(self->name, name, length);
    for (char *c = self->name; *c; c++)
        if (*c == '%')
            *c = '_'; /* hosts pass messages to printf */
    start(self);
    if (type == fmi2CoSimulation && strcmp(guid, GUID) == 0)
        return self;
    say(self, fmi2Error,
        type == fmi2CoSimulation ? "the GUID is not that of this library: unpack the FMU again"
                                 : "this part is for co-simulation only");
    free(self);
    return NULL;
}

FMI2_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component c) { free(c); }

FMI2_EXPORT fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean logging, size_t count,
                               const fmi2String categories[])
{
    Instance *self = c;
    self->logging = logging;
    self->errors = count == 0;
    for (size_t k = 0; k < count; k++)
        if (categories[k] && strcmp(categories[k], "logStatusError") == 0)
            self->errors = 1;
    return fmi2OK;
}

/* ---- FMI: life ---- */

FMI2_EXPORT fmi2Status FMI2(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance,
                               fmi2Real time, fmi2Boolean with_stop, fmi2Real stop)
{
    (void)with_tolerance, (void)tolerance, (void)with_stop, (void)stop;
    ((Instance *)c)->core.time = time;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2EnterInitializationMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2ExitInitializationMode)(fmi2Component c)
{
    Instance *self = c;
    char cause[LONGEST];
    if (!initialised(self, cause) || !refreshed(self, cause)) {
        report(self, "initialisation", cause);
        return fmi2Error;
    }
    self->core.running = 1;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2Terminate)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2Reset)(fmi2Component c)
{
    start(c);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean keep)
{
    (void)keep;
    Instance *self = c;
    Core *core = &self->core;
    char cause[LONGEST];
    if (sound(self, cause)) {
        core->time = time;
        const char *words = "the instance is not initialised";
        if (core->begun)
            words = advance(core, time, step);
        if (!words) {
            core->time = self->reached = time + step;
            self->stale = 1;
            return fmi2OK;
        }
        snprintf(cause, LONGEST, "%s", words);
    }
    report(self, "step", cause);
    self->reached = time;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(fmi2CancelStep)(fmi2Component c)
{
    return refused(c, "a step cannot be cancelled: it ends before the call returns");
}

/* ---- FMI: variables ---- */

FMI2_EXPORT fmi2Status FMI2(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[])
{
    Instance *self = c;
    long largest;
    if (!known(self, vr, count, &largest))
        return fmi2Error;
    if (self->stale && largest >= INPUTS + PARAMETERS)
        observe(self);
    for (size_t k = 0; k < count; k++)
        value[k] = self->core.values[vr[k]];
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[])
{
    Instance *self = c;
    long largest;
    if (!known(self, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++)
        self->core.values[vr[k]] = value[k];
    changed(self, largest);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Integer value[])
{
    Instance *self = c;
    long largest;
    if (!known(self, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++) {
        double number = self->core.values[vr[k]];
        if (!(fabs(number) <= 2147483647.0))
            return refused(self, "the value of this variable is no integer");
        value[k] = (fmi2Integer)number;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[])
{
    Instance *self = c;
    long largest;
    if (!known(self, vr, count, &largest))
        return fmi2Error;
    for (size_t k = 0; k < count; k++)
        self->core.values[vr[k]] = value[k];
    changed(self, largest);
    return fmi2OK;
}

static fmi2Status none(fmi2Component c, size_t count, const char *words)
{
    return count ? refused(c, words) : fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no Boolean variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no Boolean variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no String variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[])
{
    (void)vr, (void)value;
    return none(c, count, "this part has no String variables");
}

/* ---- FMI: states ---- */

FMI2_EXPORT fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    Instance *self = c;
    if (!*state)
        *state = malloc(sizeof(Core));
    if (!*state)
        return refused(self, "no memory for a state");
    memcpy(*state, &self->core, sizeof(Core));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    Instance *self = c;
    if (!state)
        return refused(self, "there is no state to set");
    memcpy(&self->core, state, sizeof(Core));
    self->stale = 1;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Packed);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
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

FMI2_EXPORT fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
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

FMI2_EXPORT fmi2Status FMI2(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t some, const fmi2ValueReference knowns[],
                                        size_t others, const fmi2Real seed[], fmi2Real value[])
{
    (void)unknowns, (void)some, (void)knowns, (void)others, (void)seed, (void)value;
    return refused(c, "directional derivatives are not offered: ports carry them as variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[],
                                       size_t count, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    (void)vr, (void)count, (void)order, (void)value;
    return refused(c, "input derivatives are not offered: ports carry them as variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[],
                                        fmi2Real value[])
{
    (void)vr, (void)count, (void)order, (void)value;
    return refused(c, "output derivatives are not offered: ports carry them as variables");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime)
        return refused(c, "the one real status is the last successful time");
    *value = ((Instance *)c)->reached;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return refused(c, "steps are synchronous: there is no pending status");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return refused(c, "there is no integer status");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)kind, (void)value;
    return refused(c, "a step never terminates the simulation");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return refused(c, "steps are synchronous: there is no pending status");
}
