/* FMI 2.0 for co-simulation around one part. */
#include "fmi2.h"

typedef const fmi2CallbackFunctions *Host;

#include "instance.h"

static void log_error(Instance *self, const char *words)
{
    if (self->host->logger)
        self->host->logger(self->host->componentEnvironment, self->name, fmi2Error,
                           "logStatusError", words);
}

static fmi2Status refused(Instance *self, const char *words)
{
    say(self, words);
    return fmi2Error;
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
    Instance *self = created(name, logging, host);
    if (!self)
        return NULL;
    if (type == fmi2CoSimulation && strcmp(guid, GUID) == 0)
        return self;
    say(self,
        type == fmi2CoSimulation ? "the GUID is not that of this library: unpack the FMU again"
                                 : "this part is for co-simulation only");
    free(self);
    return NULL;
}

FMI2_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component c) { free(c); }

FMI2_EXPORT fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean logging, size_t count,
                               const fmi2String categories[])
{
    listen(c, logging, count, categories);
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
    return begun(c) ? fmi2OK : fmi2Error;
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
    return stepped(c, time, step) ? fmi2OK : fmi2Discard;
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
    if (!known(self, vr, count, VARIABLES, &largest))
        return fmi2Error;
    read_up_to(self, largest);
    for (size_t k = 0; k < count; k++)
        value[k] = self->core.values[vr[k]];
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[])
{
    Instance *self = c;
    long largest;
    if (!known(self, vr, count, VARIABLES, &largest))
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
    if (!known(self, vr, count, VARIABLES, &largest))
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
    if (!known(self, vr, count, VARIABLES, &largest))
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
    return saved(c, state) ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    return restored(c, state) ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    forget(state);
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
    return serialised(c, state, bytes, size) ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    return deserialised(c, bytes, size, state) ? fmi2OK : fmi2Error;
}

/* ---- FMI: derivatives ---- */

FMI2_EXPORT fmi2Status FMI2(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t some, const fmi2ValueReference knowns[],
                                        size_t others, const fmi2Real seed[], fmi2Real value[])
{
    return derived(c, unknowns, some, knowns, others, seed, value) ? fmi2OK : fmi2Error;
}

/* ---- FMI: what the parts do not offer ---- */

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
