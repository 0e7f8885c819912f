/*
An instance of one part, whatever the version of FMI that a host reaches it by.

part.h says what the part has: its header, its variables in the order of their value references
(inputs, parameters, outputs) and how large the records are. The functions of the part are
translated from its physics. This file does what fmus/slave.py does for the same part with Python
in it, call by call and word by word.

An instance is one block of memory and nothing is shared between instances. All that changes in a
run is the `Core`, plain numbers, so an FMU state is a copy of it.

The file that includes this one is the interface of one version of FMI: it has declared `Host`, and
defines `log_error`.
*/
#ifndef INSTANCE_H
#define INSTANCE_H

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "part.h"

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
    int events;       /* whether the host handles events between steps */
    int early;        /* whether a step may end before its end, at an event */
    Host host;        /* where messages go: a type of the interface's version */
    char name[];
} Instance;

/* ---- messages ---- */

/* Log an error as the interface's version has it. */
static void log_error(Instance *self, const char *words);

static void say(Instance *self, const char *words)
{
    if (self->logging && self->errors)
        log_error(self, words);
}

static void report(Instance *self, const char *call, const char *cause)
{
    char words[2 * LONGEST];
    snprintf(words, sizeof words, "%s: %s at t = %g s: %s", self->name, call, self->core.time,
             cause);
    say(self, words);
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

/* Largest of some value references, or -1; refused where one is none of the first `most`. */
static int known(Instance *self, const unsigned int vr[], size_t count, long most, long *largest)
{
    *largest = -1;
    for (size_t k = 0; k < count; k++) {
        if (vr[k] >= (unsigned long)most) {
            char words[LONGEST];
            snprintf(words, sizeof words, "%s: no variable has the value reference %u", self->name,
                     vr[k]);
            say(self, words);
            return 0;
        }
        if ((long)vr[k] > *largest)
            *largest = (long)vr[k];
    }
    return 1;
}

/* Bring the outputs up to date if the largest value reference that is read is one of them. */
static void read_up_to(Instance *self, long largest)
{
    if (self->stale && largest >= INPUTS + PARAMETERS)
        observe(self);
}

static void changed(Instance *self, long largest)
{
    self->stale = 1;
    if (self->core.running && largest >= INPUTS)
        retune(self);
}

/* ---- life ---- */

static Instance *created(const char *name, int logging, Host host)
{
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
    return self;
}

static void listen(Instance *self, int logging, size_t count, const char *const categories[])
{
    self->logging = logging;
    self->errors = count == 0;
    for (size_t k = 0; k < count; k++)
        if (categories[k] && strcmp(categories[k], "logStatusError") == 0)
            self->errors = 1;
}

/* Leave the initialisation for the first step; 0 where a fault keeps it from that. */
static int begun(Instance *self)
{
    char cause[LONGEST];
    if (!initialised(self, cause) || !refreshed(self, cause)) {
        report(self, "initialisation", cause);
        return 0;
    }
    self->core.running = 1;
    return 1;
}

/* A step; 0 where it failed, with the last good state kept. */
static int stepped(Instance *self, double time, double step)
{
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
            return 1;
        }
        snprintf(cause, LONGEST, "%s", words);
    }
    report(self, "step", cause);
    self->reached = time;
    return 0;
}

/* ---- derivatives of outputs by inputs ---- */

/* Fill a record of dual numbers, in order. */
static void lift(Dual *into, size_t size, const double *values, const double *slopes)
{
    for (size_t k = 0; k < size / sizeof(Dual); k++)
        into[k] = dual_of(values[k], slopes ? slopes[k] : 0.0);
}

/* Slopes of all outputs along one direction of the inputs, at the state and inputs as they are;
   before the first step the state follows the inputs too. */
static const char *outputs_along(const Core *core, const double *seed, double *slopes)
{
    Fault fault;
    DualParams params;
    DualState state;
    DualInput input;
    const Dual time = dual_constant(core->time);
    memset(&input, 0, sizeof input);
    lift((Dual *)&params, sizeof params, core->values + INPUTS, NULL);
    lift((Dual *)&state, sizeof state, (const double *)&core->state, NULL);
    lift((Dual *)&input, sizeof input, core->values, seed);
    if (MARK(&fault))
        return fault.cause;
    const DualState at =
        core->running ? state : PART_DUAL_INITIAL(&fault, &params, &input, time);
    const DualOutput output = PART_DUAL_OBSERVE(&fault, &params, &at, &input, time);
    for (size_t k = 0; k < OUTPUTS; k++)
        slopes[k] = ((const Dual *)&output)[k].slope;
    return NULL;
}

static int among(unsigned long reference, unsigned long first, unsigned long end)
{
    return reference >= first && reference < end;
}

/* The same for some outputs and inputs; 0 where it is refused or fails. */
static int derived(Instance *self, const unsigned int unknowns[], size_t some,
                   const unsigned int knowns[], size_t others, const double seed[],
                   double sensitivity[])
{
    double direction[INPUTS + 1] = {0}, slopes[OUTPUTS];
    char cause[LONGEST];
    for (size_t k = 0; k < others; k++) {
        if (!among(knowns[k], 0, INPUTS)) {
            say(self, "directional derivatives are by inputs alone");
            return 0;
        }
        direction[knowns[k]] = seed[k];
    }
    for (size_t k = 0; k < some; k++)
        if (!among(unknowns[k], INPUTS + PARAMETERS, VARIABLES)) {
            say(self, "directional derivatives are of outputs alone");
            return 0;
        }
    if (self->core.running || initialised(self, cause)) {
        const char *words = outputs_along(&self->core, direction, slopes);
        if (!words) {
            for (size_t k = 0; k < some; k++)
                sensitivity[k] = slopes[unknowns[k] - INPUTS - PARAMETERS];
            return 1;
        }
        snprintf(cause, LONGEST, "%s", words);
    }
    report(self, "derivative", cause);
    return 0;
}

/* ---- FMU states ---- */

static int saved(Instance *self, void **state)
{
    if (!*state)
        *state = malloc(sizeof(Core));
    if (!*state) {
        say(self, "no memory for a state");
        return 0;
    }
    memcpy(*state, &self->core, sizeof(Core));
    return 1;
}

static int restored(Instance *self, const void *state)
{
    if (!state) {
        say(self, "there is no state to set");
        return 0;
    }
    memcpy(&self->core, state, sizeof(Core));
    self->stale = 1;
    return 1;
}

static void forget(void **state)
{
    if (state) {
        free(*state);
        *state = NULL;
    }
}

static int serialised(Instance *self, const void *state, void *bytes, size_t size)
{
    static const char guid[] = GUID;
    if (!state || size < sizeof(Packed)) {
        say(self, "the buffer is too small for a state");
        return 0;
    }
    memset(bytes, 0, sizeof(Packed));
    memcpy((char *)bytes + offsetof(Packed, guid), guid, sizeof guid);
    memcpy((char *)bytes + offsetof(Packed, core), state, sizeof(Core));
    return 1;
}

static int deserialised(Instance *self, const void *bytes, size_t size, void **state)
{
    if (size != sizeof(Packed) || memcmp(bytes, GUID, sizeof GUID) != 0) {
        say(self, "these bytes are no state of this build of the part");
        return 0;
    }
    if (!*state)
        *state = malloc(sizeof(Core));
    if (!*state) {
        say(self, "no memory for a state");
        return 0;
    }
    memcpy(*state, (const char *)bytes + offsetof(Packed, core), sizeof(Core));
    return 1;
}

#endif
