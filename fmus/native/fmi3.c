/*
FMI 3.0 for co-simulation around one part.

Value references are those of FMI 2.0, and the time comes after them. A part that announces the
next edge of its drive (`EVENT`) has event mode: a step ends at the edge where the host allows that,
and asks for event mode there. The part itself has nothing to do at an edge, so that a host without
event mode gets the same values.
*/
#include "fmi3.h"

typedef struct {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Host;

#include "instance.h"

#define TIME VARIABLES

static void log_error(Instance *self, const char *words)
{
    if (self->host.log)
        self->host.log(self->host.environment, fmi3Error, "logStatusError", words);
}

static fmi3Status refused(fmi3Instance c, const char *words)
{
    say(c, words);
    return fmi3Error;
}

/* ---- creation, messages ---- */

FMI3_EXPORT const char *FMI3(fmi3GetVersion)(void) { return fmi3Version; }

FMI3_STATUS(fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean logging, size_t count,
                                 const fmi3String categories[])
{
    listen(c, logging, count, categories);
    return fmi3OK;
}

static fmi3Instance other_kind(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    if (log)
        log(environment, fmi3Error, "logStatusError", "this part is for co-simulation only");
    return NULL;
}

FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference intermediate[], size_t count, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)resources, (void)visible, (void)intermediate, (void)count, (void)update;
    if (!name || !token)
        return NULL;
    const Host host = {environment, log};
    Instance *self = created(name, logging, host);
    if (!self)
        return NULL;
    self->events = events;
    self->early = early;
    if (strcmp(token, GUID) == 0)
        return self;
    say(self, "the instantiation token is not that of this library: unpack the FMU again");
    free(self);
    return NULL;
}

FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    return other_kind(environment, log);
}

FMI3_EXPORT fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    (void)update, (void)lock, (void)unlock;
    return other_kind(environment, log);
}

FMI3_EXPORT void FMI3(fmi3FreeInstance)(fmi3Instance c) { free(c); }

/* ---- life ---- */

FMI3_STATUS(fmi3EnterInitializationMode)(fmi3Instance c, fmi3Boolean with_tolerance,
                                         fmi3Float64 tolerance, fmi3Float64 time,
                                         fmi3Boolean with_stop, fmi3Float64 stop)
{
    (void)with_tolerance, (void)tolerance, (void)with_stop, (void)stop;
    ((Instance *)c)->core.time = time;
    return fmi3OK;
}

FMI3_STATUS(fmi3ExitInitializationMode)(fmi3Instance c) { return begun(c) ? fmi3OK : fmi3Error; }

FMI3_STATUS(fmi3Terminate)(fmi3Instance c)
{
    (void)c;
    return fmi3OK;
}

FMI3_STATUS(fmi3Reset)(fmi3Instance c)
{
    start(c);
    return fmi3OK;
}

/* ---- steps and events ---- */

/* When the next edge of the drive comes; never where the part announces none. */
static double next_edge(Instance *self)
{
#ifdef EVENT
    read_up_to(self, EVENT);
    const double edge = self->core.values[EVENT];
    return edge > self->core.time && edge < 1e29 ? edge : HUGE_VAL;
#else
    (void)self;
    return HUGE_VAL;
#endif
}

FMI3_STATUS(fmi3DoStep)(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean keep,
                        fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                        fmi3Float64 *reached)
{
    Instance *self = c;
    const double close = 1e-9 * step;
    const double edge = self->events ? next_edge(self) : HUGE_VAL;
    const bool inside = self->early && edge < time + step - close;
    (void)keep;
    *terminate = false;
    const bool well = stepped(self, time, inside ? edge - time : step);
    *reached = self->reached;
    *early = well && inside;
    *event = well && (inside || fabs(edge - (time + step)) <= close);
    return well ? fmi3OK : fmi3Discard;
}

FMI3_STATUS(fmi3EnterEventMode)(fmi3Instance c)
{
    return ((Instance *)c)->events ? fmi3OK
                                   : refused(c, "the instance was made without event mode");
}

FMI3_STATUS(fmi3EnterStepMode)(fmi3Instance c)
{
    (void)c;
    return fmi3OK;
}

FMI3_STATUS(fmi3UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                      fmi3Boolean *nominals, fmi3Boolean *values,
                                      fmi3Boolean *defined, fmi3Float64 *following)
{
    const double edge = next_edge(c);
    *again = *terminate = *nominals = *values = false;
    *defined = isfinite(edge);
    if (*defined)
        *following = edge;
    return fmi3OK;
}

/* ---- variables ---- */

FMI3_STATUS(fmi3GetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                            fmi3Float64 values[], size_t size)
{
    Instance *self = c;
    long largest;
    (void)size;
    if (!known(self, vr, count, TIME + 1, &largest))
        return fmi3Error;
    read_up_to(self, largest);
    for (size_t k = 0; k < count; k++)
        values[k] = vr[k] == TIME ? self->core.time : self->core.values[vr[k]];
    return fmi3OK;
}

FMI3_STATUS(fmi3SetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                            const fmi3Float64 values[], size_t size)
{
    Instance *self = c;
    long largest;
    (void)size;
    if (!known(self, vr, count, VARIABLES, &largest))
        return fmi3Error;
    for (size_t k = 0; k < count; k++)
        self->core.values[vr[k]] = values[k];
    changed(self, largest);
    return fmi3OK;
}

/* Enumerations. */
FMI3_STATUS(fmi3GetInt64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                          fmi3Int64 values[], size_t size)
{
    Instance *self = c;
    long largest;
    (void)size;
    if (!known(self, vr, count, VARIABLES, &largest))
        return fmi3Error;
    for (size_t k = 0; k < count; k++) {
        const double number = self->core.values[vr[k]];
        if (!(fabs(number) <= 2147483647.0))
            return refused(self, "the value of this variable is no integer");
        values[k] = (fmi3Int64)number;
    }
    return fmi3OK;
}

FMI3_STATUS(fmi3SetInt64)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                          const fmi3Int64 values[], size_t size)
{
    Instance *self = c;
    long largest;
    (void)size;
    if (!known(self, vr, count, VARIABLES, &largest))
        return fmi3Error;
    for (size_t k = 0; k < count; k++)
        self->core.values[vr[k]] = (double)values[k];
    changed(self, largest);
    return fmi3OK;
}

/* ---- derivatives, states ---- */

FMI3_STATUS(fmi3GetDirectionalDerivative)(fmi3Instance c, const fmi3ValueReference unknowns[],
                                          size_t some, const fmi3ValueReference knowns[],
                                          size_t others, const fmi3Float64 seed[], size_t seeds,
                                          fmi3Float64 sensitivity[], size_t sensitivities)
{
    (void)seeds, (void)sensitivities;
    return derived(c, unknowns, some, knowns, others, seed, sensitivity) ? fmi3OK : fmi3Error;
}

FMI3_STATUS(fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    return saved(c, state) ? fmi3OK : fmi3Error;
}

FMI3_STATUS(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state)
{
    return restored(c, state) ? fmi3OK : fmi3Error;
}

FMI3_STATUS(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    (void)c;
    forget(state);
    return fmi3OK;
}

FMI3_STATUS(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Packed);
    return fmi3OK;
}

FMI3_STATUS(fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[],
                                   size_t size)
{
    return serialised(c, state, bytes, size) ? fmi3OK : fmi3Error;
}

FMI3_STATUS(fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                     fmi3FMUState *state)
{
    return deserialised(c, bytes, size, state) ? fmi3OK : fmi3Error;
}

/* ---- what the parts do not offer: every host looks the functions up ---- */

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(kind) \
    FMI3_STATUS(fmi3Get##kind)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, \
                               fmi3##kind values[], size_t size) \
    { \
        return count ? refused(c, "this part has no variables of the type " #kind) : fmi3OK; \
    } \
    FMI3_STATUS(fmi3Set##kind)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, \
                               const fmi3##kind values[], size_t size) \
    { \
        return count ? refused(c, "this part has no variables of the type " #kind) : fmi3OK; \
    }

#define UNOFFERED(name, words, ...) \
    FMI3_STATUS(name)(fmi3Instance c, __VA_ARGS__) { return refused(c, words); }

#define NO_CLOCKS "this part has no clocks"
#define NO_STATES "this part is for co-simulation only"

ABSENT(Float32)
ABSENT(Int8)
ABSENT(UInt8)
ABSENT(Int16)
ABSENT(UInt16)
ABSENT(Int32)
ABSENT(UInt32)
ABSENT(UInt64)
ABSENT(Boolean)
ABSENT(String)

FMI3_STATUS(fmi3GetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                           size_t sizes[], fmi3Binary values[], size_t size)
{
    return count ? refused(c, "this part has no variables of the type Binary") : fmi3OK;
}

FMI3_STATUS(fmi3SetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                           const size_t sizes[], const fmi3Binary values[], size_t size)
{
    return count ? refused(c, "this part has no variables of the type Binary") : fmi3OK;
}

FMI3_STATUS(fmi3GetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                          fmi3Clock values[])
{
    return count ? refused(c, NO_CLOCKS) : fmi3OK;
}

FMI3_STATUS(fmi3SetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                          const fmi3Clock values[])
{
    return count ? refused(c, NO_CLOCKS) : fmi3OK;
}

UNOFFERED(fmi3GetIntervalDecimal, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
UNOFFERED(fmi3GetIntervalFraction, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
UNOFFERED(fmi3GetShiftDecimal, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          fmi3Float64 shifts[])
UNOFFERED(fmi3GetShiftFraction, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          fmi3UInt64 counters[], fmi3UInt64 resolutions[])
UNOFFERED(fmi3SetIntervalDecimal, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          const fmi3Float64 intervals[])
UNOFFERED(fmi3SetIntervalFraction, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNOFFERED(fmi3SetShiftDecimal, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          const fmi3Float64 shifts[])
UNOFFERED(fmi3SetShiftFraction, NO_CLOCKS, const fmi3ValueReference vr[], size_t count,
          const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNOFFERED(fmi3ActivateModelPartition, NO_CLOCKS, fmi3ValueReference clock, fmi3Float64 time)

UNOFFERED(fmi3GetAdjointDerivative, "adjoint derivatives are not offered: take directional ones",
          const fmi3ValueReference unknowns[], size_t some, const fmi3ValueReference knowns[],
          size_t others, const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[],
          size_t sensitivities)
UNOFFERED(fmi3GetOutputDerivatives, "output derivatives are not offered: ports carry them",
          const fmi3ValueReference vr[], size_t count, const fmi3Int32 orders[],
          fmi3Float64 values[], size_t size)
UNOFFERED(fmi3GetNumberOfVariableDependencies, "dependencies are those of the modelDescription",
          fmi3ValueReference variable, size_t *count)
UNOFFERED(fmi3GetVariableDependencies, "dependencies are those of the modelDescription",
          fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[],
          size_t other_elements[], fmi3DependencyKind kinds[], size_t count)

UNOFFERED(fmi3SetTime, NO_STATES, fmi3Float64 time)
UNOFFERED(fmi3SetContinuousStates, NO_STATES, const fmi3Float64 states[], size_t count)
UNOFFERED(fmi3GetContinuousStates, NO_STATES, fmi3Float64 states[], size_t count)
UNOFFERED(fmi3GetContinuousStateDerivatives, NO_STATES, fmi3Float64 rates[], size_t count)
UNOFFERED(fmi3GetNominalsOfContinuousStates, NO_STATES, fmi3Float64 nominals[], size_t count)
UNOFFERED(fmi3GetEventIndicators, NO_STATES, fmi3Float64 indicators[], size_t count)
UNOFFERED(fmi3GetNumberOfContinuousStates, NO_STATES, size_t *count)
UNOFFERED(fmi3GetNumberOfEventIndicators, NO_STATES, size_t *count)
UNOFFERED(fmi3CompletedIntegratorStep, NO_STATES, fmi3Boolean keep, fmi3Boolean *event,
          fmi3Boolean *terminate)

FMI3_STATUS(fmi3EnterContinuousTimeMode)(fmi3Instance c) { return refused(c, NO_STATES); }

FMI3_STATUS(fmi3EvaluateDiscreteStates)(fmi3Instance c)
{
    return refused(c, "discrete states are updated, never evaluated alone");
}

FMI3_STATUS(fmi3EnterConfigurationMode)(fmi3Instance c)
{
    return refused(c, "this part has no structural parameters");
}

FMI3_STATUS(fmi3ExitConfigurationMode)(fmi3Instance c)
{
    return refused(c, "this part has no structural parameters");
}
