/*
Small co-simulation FMUs that stand for foreign ones: one model and one version of FMI per library.

  -DMODEL_PAIR | MODEL_MASS | MODEL_POPULATION | MODEL_GAIN | MODEL_TYPES | MODEL_DECAY
  | MODEL_TANK | MODEL_RELAY | MODEL_LAG | MODEL_FAULTY
  -DFMI_VERSION=2 | 3
  -DROLLBACK        the state can be taken, set back and freed; else these calls fail
  -DFORGETFUL       setting it back is reported as done, and is not
  -DVARIABLE_STEP   steps of any size; else all must have the size of the first
  -DINTERPOLATES    LAG: its input may rise over a step
  -DONCE            one instance in a process, ever
  -DFAULT=n         14 hangs FAULTY in instantiate; the others are its parameter, see `strike`

`variables.h` comes from build.py, which writes modelDescription.xml from the same table:
VARIABLES(V) lists V(name, kind, length, access, start) in the order of value references.
*/
#define _GNU_SOURCE
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "variables.h"

#define PASTE(a, b, c) a##b##c
#if FMI_VERSION == 2
#include "fmi2Functions.h"
#define FMI(name) fmi2##name
#define OF_STATE(verb) PASTE(fmi2, verb, FMUstate)
#else
#include "fmi3Functions.h"
#define FMI(name) fmi3##name
#define OF_STATE(verb) PASTE(fmi3, verb, FMUState)
#endif

typedef FMI(Status) Status;
typedef FMI(Boolean) Truth;
typedef FMI(ValueReference) Reference;

#ifndef FAULT
#define FAULT 0
#endif

typedef enum { Float64, Float32, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Boolean,
               String, Binary } Kind;
typedef enum { NEVER, EARLY, ALWAYS } Access; /* when it may be set; EARLY: before stepping */

typedef union { /* one value, at its start */
    double Float64[4];
    float Float32[1];
    int8_t Int8[1];
    uint8_t UInt8[1];
    int16_t Int16[1];
    uint16_t UInt16[1];
    int32_t Int32[1];
    uint32_t UInt32[1];
    int64_t Int64[1];
    uint64_t UInt64[1];
    Truth Boolean[1];
    char String[64];
    struct { uint8_t bytes[64]; size_t size; } Binary;
} Cell;

#define V(name, ...) V_##name,
enum { VARIABLES(V) COUNT };
#undef V
#define V(name, kind, length, access, ...) {kind, length, access},
static const struct { Kind kind; size_t length; Access access; } TABLE[COUNT] = {VARIABLES(V)};
#undef V
#define V(name, kind, length, access, ...) __VA_ARGS__,
static const Cell STARTS[COUNT] = {VARIABLES(V)};
#undef V

typedef struct { /* all that rollback has to restore */
    double time;
    double stop;     /* of the run, 0 if it was not told */
    double reached;  /* DECAY: the time up to which it has integrated */
    double x, v;     /* MASS: displacement and velocity; FAULTY: x is the integral of u */
    double rise;     /* LAG: rate of its input */
    double growth;   /* FAULTY: what its output has grown by */
    bool ready;      /* initialised */
    bool stricken;   /* FAULTY: its output is not a number */
    Cell cells[COUNT];
} State;

typedef struct {
    State state;
    double step;     /* size of the first step */
    bool flooded;    /* FAULTY: the flood of fault 7 has been logged */
    char name[64];
    void *environment;
#if FMI_VERSION == 2
    fmi2CallbackLogger logger;
#else
    fmi3LogMessageCallback logger;
#endif
} Instance;

typedef struct { bool event, terminate, early; } Report; /* what FMI 3 returns beside the status */

#define AT(name, kind) (s->cells[V_##name].kind[0])
#define R(name) AT(name, Float64)

/* Log to the host, if it has a logger; returns the status. No '%' in the text: FMI 2 formats it. */
static Status logged(Instance *it, Status status, const char *text)
{
    const char *category = status < FMI(Error) ? "logStatusWarning" : "logStatusError";
    if (it->logger)
#if FMI_VERSION == 2
        it->logger(it->environment, it->name, status, category, text);
#else
        it->logger(it->environment, status, category, text);
#endif
    return status;
}

/* --------------------------------------------------------------------------------------- models */

#if defined MODEL_PAIR

static void law(State *s, int first, double x, double v, double x_other, double v_other)
{
    const double own = R(stiffness) + R(ground_stiffness);
    const double members[] = {
        -R(ground_stiffness) * x - R(stiffness) * (x - x_other) - R(damping) * (v - v_other),
        own, R(damping), R(stiffness) * v_other, x, v, s->time,
    };
    for (size_t k = 0; k < sizeof members / sizeof *members; k++)
        s->cells[first + k].Float64[0] = members[k];
}

static void observe(State *s)
{
    const double x1 = R(first_displacement), v1 = R(first_velocity);
    const double x2 = R(second_displacement), v2 = R(second_velocity);
    law(s, V_first_value, x1, v1, x2, v2);
    law(s, V_second_value, x2, v2, x1, v1);
}

static void integrate(State *s, double size) { (void)s, (void)size; }

#elif defined MODEL_MASS

static void observe(State *s)
{
    if (!s->ready) {
        s->x = R(start_displacement);
        s->v = R(start_velocity);
    }
    R(displacement) = s->x;
    R(velocity) = s->v;
}

/* Exact where nothing damps; else Runge-Kutta 4, 50 steps or more in the shorter time scale. */
static void integrate(State *s, double size)
{
    const double m = R(mass), k = R(stiffness), d = R(damping), f = R(force);
    if (d == 0.0 && k == 0.0) {
        s->x += size * (s->v + 0.5 * size * f / m);
        s->v += size * f / m;
    } else if (d == 0.0) {
        const double w = sqrt(k / m), u = s->x - f / k, v = s->v;
        s->x = f / k + u * cos(w * size) + v / w * sin(w * size);
        s->v = v * cos(w * size) - u * w * sin(w * size);
    } else {
        const double scale = fmin(m / fabs(d), k > 0.0 ? sqrt(m / k) : INFINITY);
        const double count = ceil(50.0 * size / scale);
        const double h = size / count;
#define PULL(x, v) ((f - d * (v) - k * (x)) / m)
        for (double n = 0; n < count; n++) {
            const double x = s->x, v = s->v;
            const double a1 = PULL(x, v), v2 = v + 0.5 * h * a1;
            const double a2 = PULL(x + 0.5 * h * v, v2), v3 = v + 0.5 * h * a2;
            const double a3 = PULL(x + 0.5 * h * v2, v3), v4 = v + h * a3;
            const double a4 = PULL(x + h * v3, v4);
            s->x = x + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
            s->v = v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
        }
    }
}

#elif defined MODEL_POPULATION

static void observe(State *s)
{
    if (!s->ready)
        s->x = R(start_size);
    R(size) = s->x;
}

/* Exact for a partner that stays as it is. */
static void integrate(State *s, double size) { s->x *= exp((R(growth) + R(effect) * R(other)) * size); }

#elif defined MODEL_LAG

static void observe(State *s)
{
    if (!s->ready)
        s->x = R(start);
    R(y) = s->x;
}

/* Exact for an input that rises evenly: y' = u + r t - y. */
static void integrate(State *s, double size)
{
    const double r = s->rise, u = R(u);
    s->x = (s->x - u + r) * exp(-size) + u - r + r * size;
}

#elif defined MODEL_GAIN

static void observe(State *s) { R(y) = R(gain) * R(u) + R(offset); }

static void integrate(State *s, double size) { (void)s, (void)size; }

#elif defined MODEL_TANK

static void observe(State *s)
{
    if (!s->ready)
        s->x = R(start_level);
    R(level) = s->x;
}

/* Exact: x' = on inflow - k x. */
static void integrate(State *s, double size)
{
    const double rest = AT(open, Boolean) ? R(inflow) / R(k) : 0.0;
    s->x = rest + (s->x - rest) * exp(-R(k) * size);
}

#elif defined MODEL_RELAY

/* It keeps what it has between its bounds, and looks at the end of each step. */
static void observe(State *s)
{
    if (!s->ready)
        s->cells[V_open].Boolean[0] = R(level) < R(high);
    strcpy(s->cells[V_state].String, s->cells[V_open].Boolean[0] ? "geöffnet" : "zu");
}

static void integrate(State *s, double size)
{
    (void)size;
    if (R(level) > R(high))
        s->cells[V_open].Boolean[0] = 0;
    else if (R(level) < R(low))
        s->cells[V_open].Boolean[0] = 1;
}

#elif defined MODEL_TYPES

#if FMI_VERSION == 2
#define ECHOES(SAME, NEXT) \
    SAME(real, Float64) SAME(enumeration, Int32) NEXT(integer, Int32, INT32_MAX)
#else
#define ECHOES(SAME, NEXT) \
    SAME(float64, Float64) SAME(float32, Float32) SAME(enumeration, Int64) \
    NEXT(int8, Int8, INT8_MAX) NEXT(uint8, UInt8, UINT8_MAX) \
    NEXT(int16, Int16, INT16_MAX) NEXT(uint16, UInt16, UINT16_MAX) \
    NEXT(int32, Int32, INT32_MAX) NEXT(uint32, UInt32, UINT32_MAX) \
    NEXT(int64, Int64, INT64_MAX) NEXT(uint64, UInt64, UINT64_MAX)
#endif
#define SAME(type, kind) AT(out_##type, kind) = AT(in_##type, kind);
#define NEXT(type, kind, most) SAME(type, kind) AT(out_##type, kind) += AT(in_##type, kind) < most;
#define LATE(type, ...) s->cells[V_late_##type] = s->cells[V_out_##type];

static void integrate(State *s, double size)
{
    (void)size;
    ECHOES(LATE, LATE)
    LATE(boolean)
}

static void observe(State *s)
{
    ECHOES(SAME, NEXT)
    AT(out_boolean, Boolean) = !AT(in_boolean, Boolean);
    s->cells[V_out_string] = s->cells[V_in_string];
#if FMI_VERSION == 3
    for (int k = 0; k < 3; k++)
        s->cells[V_out_array].Float64[k] = 2.0 * s->cells[V_in_array].Float64[k];
    for (int k = 0; k < 4; k++) /* transposed */
        s->cells[V_out_matrix].Float64[k] = s->cells[V_in_matrix].Float64[2 * (k % 2) + k / 2];
    Cell *binary = &s->cells[V_out_binary]; /* 00 ff, then the characters of in_string */
    binary->Binary.size = 2 + strlen(s->cells[V_in_string].String);
    memcpy(binary->Binary.bytes, "\x00\xff", 2);
    memcpy(binary->Binary.bytes + 2, s->cells[V_in_string].String, binary->Binary.size - 2);
#endif
    if (!s->ready) /* nothing came before */
        integrate(s, 0.0);
}

#elif defined MODEL_DECAY

static double first_number(const char *path)
{
    double found = 0.0;
    FILE *file = *path ? fopen(path, "r") : NULL;
    if (file && fscanf(file, "%lf", &found) != 1)
        found = 0.0;
    if (file)
        fclose(file);
    return found;
}

static void observe(State *s)
{
    if (!s->ready) {
        s->x = R(x);
        R(found) = first_number(s->cells[V_table].String);
    }
    R(x) = s->x;
    R(rate) = -R(k) * s->x;
}

/* An eager one goes on to the stop time that it was told, and then does nothing more. */
static void integrate(State *s, double size)
{
    const double end = AT(eager, Boolean) && s->stop > 0.0 ? s->stop : s->time + size;
    const double from = fmax(s->time, s->reached);
    if (end > from)
        s->x *= exp(-R(k) * (end - from));
    s->reached = end;
}

#elif defined MODEL_FAULTY

static void observe(State *s)
{
    R(y) = s->stricken ? NAN : R(gain) * R(u) + R(offset) + s->growth;
    R(x) = s->stricken ? NAN : s->x;
}

static void integrate(State *s, double size) { s->x += size * R(u); }

static void crash(void)
{
    volatile int *volatile nowhere = NULL;
    *nowhere = 1;
}

/* Mark by a file, once, that fault_time or a hang is reached. */
static void announce(void)
{
    static bool announced = false;
    const char *path = getenv("RESILIN_TEST_REACHED");
    FILE *file = announced || !path ? NULL : fopen(path, "w");
    if (file)
        fclose(file);
    announced = true;
}

static void hang(void)
{
    announce();
    for (;;)
        sleep(1);
}

static void exhaust_memory(void)
{
    const size_t size = 16 << 20;
    for (;;) {
        void *volatile block = malloc(size);
        if (!block)
            abort();
        memset(block, 1, size);
    }
}

static void flood(Instance *it)
{
    char line[1024];
    memset(line, 'x', sizeof line);
    memcpy(line, "\x1b[31m", 5);
    line[sizeof line - 1] = '\0';
    for (int k = 0; k < 10240; k++) {
        logged(it, FMI(Warning), line);
        puts(line);
    }
    fflush(stdout);
}

/* The fault, in every step from the first that reaches fault_time on. May shorten the step. */
/* Leave a process behind in a session of its own, once. */
static void escape(void)
{
    static bool escaped = false;
    if (escaped)
        return;
    escaped = true;
    if (fork())
        return;
    setsid();
    if (!fork())
        sleep(600);
    _exit(0);
}

static Status strike(Instance *it, double *size, Report *report)
{
    State *s = &it->state;
    if (s->time + *size < R(fault_time) - 1e-9 * fmax(1.0, fabs(R(fault_time))))
        return FMI(OK);
    announce();
    switch (AT(fault, Int32)) {
    case 1: crash(); break;
    case 2: hang(); break;
    case 3: s->stricken = true; break;
    case 4: exit(0);
    case 5: abort();
    case 6: exhaust_memory(); break;
    case 7:
        if (!it->flooded)
            flood(it);
        it->flooded = true;
        break;
    case 8: return FMI(Discard);
    case 9: return logged(it, FMI(Error), "the bearing has seized");
    case 10: return FMI(Fatal);
    case 11:
        *size *= FMI_VERSION == 3 ? 0.5 : 1.0;
        report->early = true;
        break;
    case 12: report->terminate = true; break;
    case 15: s->growth = s->growth == 0.0 ? 10.0 : fmin(10.0 * s->growth, 1e300); break;
    case 17: report->event = true; break;
    case 18: escape(); break;
    default: break; /* 13, 14 and 16 strike in freeInstance, instantiate and terminate */
    }
    return FMI(OK);
}

#endif

/* ------------------------------------------------------------------- what models have in common */

static void start(State *s)
{
    memset(s, 0, sizeof *s);
    memcpy(s->cells, STARTS, sizeof STARTS);
}

/* True for the first instance of a process, however often the library is loaded or copied. */
static bool permitted(void)
{
#ifdef ONCE
    char process[32];
    snprintf(process, sizeof process, "%ld", (long)getpid());
    const char *key = FMI_VERSION == 2 ? "FOREIGN_2_" TOKEN : "FOREIGN_3_" TOKEN;
    const char *taken = getenv(key);
    if (taken && strcmp(taken, process) == 0)
        return false;
    setenv(key, process, 1);
#endif
    return true;
}

static Instance *create(const char *name, const char *token, void *environment, void *logger)
{
#ifdef MODEL_FAULTY
    if (FAULT == 14)
        hang();
#endif
    Instance *it = calloc(1, sizeof *it);
    if (!it)
        return NULL;
    it->environment = environment;
    memcpy(&it->logger, &logger, sizeof it->logger);
    snprintf(it->name, sizeof it->name, "%s", name ? name : "");
    start(&it->state);
    if (token && strcmp(token, TOKEN) == 0 && permitted())
        return it;
    logged(it, FMI(Error), "refused: a wrong token, or a second instance in this process");
    free(it);
    return NULL;
}

static Status advance(Instance *it, double time, double size, Report *report)
{
    State *s = &it->state;
    if (!s->ready || !(size >= 0.0))
        return logged(it, FMI(Error), "a step before the end of initialisation, or backwards");
#ifndef VARIABLE_STEP
    it->step = it->step == 0.0 ? size : it->step;
    if (fabs(size - it->step) > 1e-9 * it->step)
        return logged(it, FMI(Error), "a step of another size than the first");
#endif
    s->time = time;
    Status status = FMI(OK);
#ifdef MODEL_FAULTY
    status = strike(it, &size, report);
#endif
    if (status != FMI(OK))
        return status;
    observe(s);
    integrate(s, size);
    s->time = time + size;
    return FMI(OK);
}

static size_t width(Kind kind) /* bytes of one element in the host's array */
{
    const size_t widths[] = {8, 4, 1, 1, 2, 2, 4, 4, 8, 8, sizeof(Truth), sizeof(char *)};
    return widths[kind];
}

static Status unfit(Instance *it, Kind kind, const Reference at[], size_t count, size_t room)
{
    size_t needed = 0;
    for (size_t k = 0; k < count; k++) {
        if (at[k] >= COUNT || TABLE[at[k]].kind != kind)
            return logged(it, FMI(Error), "no variable of this type has this value reference");
        needed += TABLE[at[k]].length;
    }
    return needed == room ? FMI(OK) : logged(it, FMI(Error), "the number of values does not fit");
}

static Status fetch(void *instance, Kind kind, const Reference at[], size_t count, void *values,
                    size_t room)
{
    Instance *it = instance;
    if (unfit(it, kind, at, count, room) != FMI(OK))
        return FMI(Error);
    observe(&it->state);
#if FMI_VERSION == 3
    it->state.cells[V_time].Float64[0] = it->state.time;
#endif
    char *to = values;
    for (size_t k = 0; k < count; k++) {
        Cell *cell = &it->state.cells[at[k]];
        const char *text = cell->String;
        const size_t size = width(kind) * TABLE[at[k]].length;
        memcpy(to, kind == String ? (const void *)&text : cell, size);
        to += size;
    }
    return FMI(OK);
}

static Status store(void *instance, Kind kind, const Reference at[], size_t count,
                    const void *values, size_t room)
{
    Instance *it = instance;
    if (unfit(it, kind, at, count, room) != FMI(OK))
        return FMI(Error);
    const char *from = values;
    for (size_t k = 0; k < count; k++) {
        Cell *cell = &it->state.cells[at[k]];
        const Access access = TABLE[at[k]].access;
        const size_t size = width(kind) * TABLE[at[k]].length;
        if (access == NEVER || (access == EARLY && it->state.ready))
            return logged(it, FMI(Error), "this variable cannot be set, or not any more");
        if (kind == String) {
            const char *text = ((const char *const *)values)[k];
            if (!text || strlen(text) > sizeof cell->String - 3)
                return logged(it, FMI(Error), "not a text, or one of more than 61 bytes");
            strcpy(cell->String, text);
        } else {
            memcpy(cell, from, size);
        }
        from += size;
    }
    return FMI(OK);
}

/* ---------------------------------------------------------- the interface, where versions agree */

const char *FMI(GetVersion)(void) { return FMI_VERSION == 2 ? "2.0" : "3.0"; }

Status FMI(SetDebugLogging)(void *, Truth, size_t, const char *const[]) { return FMI(OK); }

void FMI(FreeInstance)(void *instance)
{
#ifdef MODEL_FAULTY
    State *s = instance ? &((Instance *)instance)->state : NULL;
    if (s && AT(fault, Int32) == 13)
        crash();
#endif
    free(instance);
}

Status FMI(ExitInitializationMode)(void *instance)
{
    State *s = &((Instance *)instance)->state;
    observe(s);
    s->ready = true;
    return FMI(OK);
}

Status FMI(Terminate)(void *instance)
{
#ifdef MODEL_FAULTY
    State *s = &((Instance *)instance)->state;
    if (AT(fault, Int32) == 16)
        hang();
#endif
    (void)instance;
    return FMI(OK);
}

Status FMI(Reset)(void *instance)
{
    start(&((Instance *)instance)->state);
    ((Instance *)instance)->step = 0.0;
    return FMI(OK);
}

#define REFUSED(...) REFUSED_(__VA_ARGS__)
#define REFUSED_(name, ...) \
    Status name(void *instance, ##__VA_ARGS__) \
    { return logged(instance, FMI(Error), #name " is not offered"); }

#ifdef ROLLBACK

Status OF_STATE(Get)(void *instance, void **taken)
{
    if (!*taken)
        *taken = malloc(sizeof(State));
    if (!*taken)
        return logged(instance, FMI(Error), "no memory for the state");
    memcpy(*taken, &((Instance *)instance)->state, sizeof(State));
    return FMI(OK);
}

Status OF_STATE(Set)(void *instance, void *taken)
{
#ifndef FORGETFUL
    memcpy(&((Instance *)instance)->state, taken, sizeof(State));
#else
    (void)instance, (void)taken;
#endif
    return FMI(OK);
}

Status OF_STATE(Free)(void *, void **taken)
{
    free(*taken);
    *taken = NULL;
    return FMI(OK);
}

#else

REFUSED(OF_STATE(Get), void **)
REFUSED(OF_STATE(Set), void *)
REFUSED(OF_STATE(Free), void **)

#endif

/* ---------------------------------------------------------------------------------------- FMI 2 */

#if FMI_VERSION == 2

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String,
                              const fmi2CallbackFunctions *functions, fmi2Boolean, fmi2Boolean)
{
    if (type != fmi2CoSimulation || !functions)
        return NULL;
    return create(name, guid, functions->componentEnvironment, functions->logger);
}

Status fmi2SetupExperiment(void *instance, Truth, double, double time, Truth told, double stop)
{
    ((Instance *)instance)->state.time = time;
    ((Instance *)instance)->state.stop = told ? stop : 0.0;
    return fmi2OK;
}

Status fmi2EnterInitializationMode(void *) { return fmi2OK; }

Status fmi2DoStep(void *instance, double time, double size, Truth)
{
    Report ignored = {0};
    return advance(instance, time, size, &ignored);
}

Status fmi2GetRealStatus(void *instance, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = ((Instance *)instance)->state.time;
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

Status fmi2GetBooleanStatus(void *, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = fmi2False;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define ACCESS(name, kind, type) \
    Status fmi2Get##name(void *instance, const Reference at[], size_t count, type values[]) \
    { return fetch(instance, kind, at, count, values, count); } \
    Status fmi2Set##name(void *instance, const Reference at[], size_t count, const type values[]) \
    { return store(instance, kind, at, count, values, count); }

ACCESS(Real, Float64, fmi2Real)
ACCESS(Integer, Int32, fmi2Integer)
ACCESS(Boolean, Boolean, fmi2Boolean)
ACCESS(String, String, fmi2String)

#define REFERENCES const Reference[], size_t

REFUSED(fmi2SerializedFMUstateSize, void *, size_t *)
REFUSED(fmi2SerializeFMUstate, void *, char[], size_t)
REFUSED(fmi2DeSerializeFMUstate, const char[], size_t, void **)
REFUSED(fmi2GetDirectionalDerivative, REFERENCES, REFERENCES, const double[], double[])
#ifdef INTERPOLATES
Status fmi2SetRealInputDerivatives(void *instance, const Reference at[], size_t count,
                                   const int order[], const double value[])
{
    if (count != 1 || at[0] != V_u || order[0] != 1)
        return logged(instance, fmi2Error, "only the first derivative of u can be set");
    ((Instance *)instance)->state.rise = value[0];
    return fmi2OK;
}

Status fmi2GetRealOutputDerivatives(void *instance, const Reference at[], size_t count,
                                    const int order[], double value[])
{
    State *s = &((Instance *)instance)->state;
    if (count != 1 || at[0] != V_y || order[0] != 1)
        return logged(instance, fmi2Error, "only the first derivative of y is there");
    value[0] = R(u) - s->x;
    return fmi2OK;
}
#else
REFUSED(fmi2GetRealOutputDerivatives, REFERENCES, const int[], double[])
REFUSED(fmi2SetRealInputDerivatives, REFERENCES, const int[], const double[])
#endif
REFUSED(fmi2CancelStep)
REFUSED(fmi2GetStatus, const fmi2StatusKind, fmi2Status *)
REFUSED(fmi2GetIntegerStatus, const fmi2StatusKind, fmi2Integer *)
REFUSED(fmi2GetStringStatus, const fmi2StatusKind, fmi2String *)

/* ---------------------------------------------------------------------------------------- FMI 3 */

#else

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String, bool, bool, bool, bool, const Reference[],
    size_t, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback)
{
    return create(name, token, environment, logger);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, bool, bool,
                                          fmi3InstanceEnvironment, fmi3LogMessageCallback)
{
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String, fmi3String, fmi3String, bool, bool, fmi3InstanceEnvironment, fmi3LogMessageCallback,
    fmi3ClockUpdateCallback, fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback)
{
    return NULL;
}

Status fmi3EnterInitializationMode(void *instance, bool, double, double time, bool told,
                                   double stop)
{
    ((Instance *)instance)->state.time = time;
    ((Instance *)instance)->state.stop = told ? stop : 0.0;
    return fmi3OK;
}

Status fmi3DoStep(void *instance, double time, double size, bool, bool *event, bool *terminate,
                  bool *early, double *reached)
{
    Report report = {0};
    const Status status = advance(instance, time, size, &report);
    *event = report.event;
    *terminate = report.terminate;
    *early = report.early;
    *reached = ((Instance *)instance)->state.time;
    return status;
}

#define ACCESS(kind) \
    Status fmi3Get##kind(void *instance, const Reference at[], size_t count, fmi3##kind values[], \
                         size_t room) \
    { return fetch(instance, kind, at, count, values, room); } \
    Status fmi3Set##kind(void *instance, const Reference at[], size_t count, \
                         const fmi3##kind values[], size_t room) \
    { return store(instance, kind, at, count, values, room); }

ACCESS(Float64)
ACCESS(Float32)
ACCESS(Int8)
ACCESS(UInt8)
ACCESS(Int16)
ACCESS(UInt16)
ACCESS(Int32)
ACCESS(UInt32)
ACCESS(Int64)
ACCESS(UInt64)
ACCESS(Boolean)
ACCESS(String)

Status fmi3GetBinary(void *instance, const Reference at[], size_t count, size_t sizes[],
                     fmi3Binary values[], size_t room)
{
    Instance *it = instance;
    if (unfit(it, Binary, at, count, room) != fmi3OK)
        return fmi3Error;
    observe(&it->state);
    for (size_t k = 0; k < count; k++) {
        sizes[k] = it->state.cells[at[k]].Binary.size;
        values[k] = it->state.cells[at[k]].Binary.bytes;
    }
    return fmi3OK;
}

#define REFERENCES const Reference[], size_t
#define SENSITIVITY REFERENCES, REFERENCES, const double[], size_t, double[], size_t

REFUSED(fmi3SetBinary, REFERENCES, const size_t[], const fmi3Binary[], size_t)
REFUSED(fmi3GetClock, REFERENCES, bool[])
REFUSED(fmi3SetClock, REFERENCES, const bool[])
REFUSED(fmi3GetNumberOfVariableDependencies, Reference, size_t *)
REFUSED(fmi3GetVariableDependencies, Reference, size_t[], Reference[], size_t[],
        fmi3DependencyKind[], size_t)
REFUSED(fmi3SerializedFMUStateSize, void *, size_t *)
REFUSED(fmi3SerializeFMUState, void *, fmi3Byte[], size_t)
REFUSED(fmi3DeserializeFMUState, const fmi3Byte[], size_t, void **)
REFUSED(fmi3GetDirectionalDerivative, SENSITIVITY)
REFUSED(fmi3GetAdjointDerivative, SENSITIVITY)
REFUSED(fmi3EnterConfigurationMode)
REFUSED(fmi3ExitConfigurationMode)
REFUSED(fmi3GetIntervalDecimal, REFERENCES, double[], fmi3IntervalQualifier[])
REFUSED(fmi3GetIntervalFraction, REFERENCES, uint64_t[], uint64_t[], fmi3IntervalQualifier[])
REFUSED(fmi3GetShiftDecimal, REFERENCES, double[])
REFUSED(fmi3GetShiftFraction, REFERENCES, uint64_t[], uint64_t[])
REFUSED(fmi3SetIntervalDecimal, REFERENCES, const double[])
REFUSED(fmi3SetIntervalFraction, REFERENCES, const uint64_t[], const uint64_t[])
REFUSED(fmi3SetShiftDecimal, REFERENCES, const double[])
REFUSED(fmi3SetShiftFraction, REFERENCES, const uint64_t[], const uint64_t[])
REFUSED(fmi3EvaluateDiscreteStates)
REFUSED(fmi3UpdateDiscreteStates, bool *, bool *, bool *, bool *, bool *, double *)
REFUSED(fmi3EnterEventMode)
REFUSED(fmi3EnterContinuousTimeMode)
REFUSED(fmi3CompletedIntegratorStep, bool, bool *, bool *)
REFUSED(fmi3SetTime, double)
REFUSED(fmi3SetContinuousStates, const double[], size_t)
REFUSED(fmi3GetContinuousStateDerivatives, double[], size_t)
REFUSED(fmi3GetEventIndicators, double[], size_t)
REFUSED(fmi3GetContinuousStates, double[], size_t)
REFUSED(fmi3GetNominalsOfContinuousStates, double[], size_t)
REFUSED(fmi3GetNumberOfEventIndicators, size_t *)
REFUSED(fmi3GetNumberOfContinuousStates, size_t *)
REFUSED(fmi3EnterStepMode)
REFUSED(fmi3GetOutputDerivatives, REFERENCES, const int32_t[], double[], size_t)
REFUSED(fmi3ActivateModelPartition, Reference, double)

#endif
