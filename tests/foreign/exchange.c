/*
Small FMUs for model exchange: one model and one version of FMI per library.

  -DMODEL_DECAY | MODEL_VAN_DER_POL | MODEL_BALL | MODEL_MASS | MODEL_SPRING | MODEL_CLOCK
  -DFMI_VERSION=2 | 3
  -DTOKEN="..."

All variables are doubles in `r`, in the order of value references; exchange.py lists the same.
*/
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#if FMI_VERSION == 2
#include "fmi2Functions.h"
#define FMI(name) fmi2##name
#else
#include "fmi3Functions.h"
#define FMI(name) fmi3##name
#endif

typedef FMI(Status) Status;
typedef FMI(Boolean) Truth;
typedef FMI(ValueReference) Reference;

#if defined MODEL_DECAY        /* x' = u - k x */
enum { X, U, K, X0, COUNT };
enum { STATES = 1, INDICATORS = 0 };
static const double START[] = {1.0, 0.0, 1.0, 1.0};
static const int STATE[] = {X};
static const int FROM[] = {X0};
static void rates(const double *r, double *d) { d[0] = r[U] - r[K] * r[X]; }
#elif defined MODEL_VAN_DER_POL /* x' = y, y' = mu (1 - x^2) y - x */
enum { X, Y, MU, X0, Y0, COUNT };
enum { STATES = 2, INDICATORS = 0 };
static const double START[] = {2.0, 0.0, 1.0, 2.0, 0.0};
static const int STATE[] = {X, Y};
static const int FROM[] = {X0, Y0};
static void rates(const double *r, double *d)
{
    d[0] = r[Y];
    d[1] = r[MU] * (1.0 - r[X] * r[X]) * r[Y] - r[X];
}
#elif defined MODEL_BALL       /* h' = v, v' = -g; v jumps to -e v on the ground */
enum { H, V, G, E, H0, BOUNCES, COUNT };
enum { STATES = 2, INDICATORS = 1 };
static const double START[] = {1.0, 0.0, 9.81, 0.7, 1.0, 0.0};
static const int STATE[] = {H, V};
static const int FROM[] = {H0, -1};
static void rates(const double *r, double *d) { d[0] = r[V]; d[1] = -r[G]; }
#elif defined MODEL_MASS       /* x' = v, v' = f/m */
enum { X, V, F, M, X0, COUNT };
enum { STATES = 2, INDICATORS = 0 };
static const double START[] = {0.0, 0.0, 0.0, 1.0, 0.0};
static const int STATE[] = {X, V};
static const int FROM[] = {X0, -1};
static void rates(const double *r, double *d) { d[0] = r[V]; d[1] = r[F] / r[M]; }
#elif defined MODEL_SPRING     /* f = k (x2 - x1) + c (v2 - v1) on the first, -f on the second */
enum { F1, F2, X1, V1, X2, V2, K, C, GROUND, COUNT };
enum { STATES = 0, INDICATORS = 0 };
static const double START[] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0};
static const int STATE[] = {-1};
static const int FROM[] = {-1};
static void rates(const double *r, double *d) { (void)r; (void)d; }
#else                          /* CLOCK: n counts the seconds that are multiples of the period */
enum { N, PERIOD, LAST, COUNT };
enum { STATES = 0, INDICATORS = 0 };
static const double START[] = {0.0, 0.25, 0.0};
static const int STATE[] = {-1};
static const int FROM[] = {-1};
static void rates(const double *r, double *d) { (void)r; (void)d; }
#endif

typedef struct {
    double time;
    double r[COUNT];
    bool event;      /* event mode, after initialisation */
    bool ready;
    double sign;     /* BALL: the side of the indicator that was seen last */
} Instance;

static void outputs(Instance *it)
{
    (void)it;
#ifdef MODEL_SPRING
    double *r = it->r;
    double pull = r[K] * (r[X2] - r[X1]) + r[C] * (r[V2] - r[V1]);
    r[F1] = pull - r[GROUND] * r[X1];
    r[F2] = -pull - r[GROUND] * r[X2];
#endif
}

static Status mode(Instance *it, bool event)
{
    if (!it->ready || it->event == event) return FMI(Error);
    it->event = event;
    return FMI(OK);
}

/* One round of an event; the time of the next one, or a negative number. */
static double update(Instance *it)
{
#ifdef MODEL_BALL
    if (it->r[H] <= 0.0 && it->r[V] < 0.0) {
        it->r[H] = 0.0;
        it->r[V] = -it->r[E] * it->r[V];
        it->r[BOUNCES] += 1.0;
    }
#endif
#ifdef MODEL_CLOCK
    if (it->time >= it->r[LAST] + it->r[PERIOD] - 1e-9) {
        it->r[LAST] += it->r[PERIOD];
        it->r[N] += 1.0;
    }
    return it->r[LAST] + it->r[PERIOD];
#endif
    (void)it;
    return -1.0;
}

static void *made(const char *token)
{
    if (strcmp(token, TOKEN)) return NULL;
    Instance *it = calloc(1, sizeof *it);
    if (it) memcpy(it->r, START, sizeof START);
    return it;
}

static Status ready(Instance *it)
{
    for (int k = 0; k < STATES; k++)
        if (FROM[k] >= 0) it->r[STATE[k]] = it->r[FROM[k]];
    it->ready = it->event = true;
    return FMI(OK);
}

static Status get(Instance *it, const Reference *at, size_t count, double *values)
{
    outputs(it);
    for (size_t k = 0; k < count; k++) {
        if (at[k] >= COUNT) return FMI(Error);
        values[k] = it->r[at[k]];
    }
    return FMI(OK);
}

static Status set(Instance *it, const Reference *at, size_t count, const double *values)
{
    for (size_t k = 0; k < count; k++) {
        if (at[k] >= COUNT) return FMI(Error);
        it->r[at[k]] = values[k];
    }
    return FMI(OK);
}

#define IT ((Instance *)instance)
#define OF FMI(Instance) instance
#if FMI_VERSION == 2
typedef fmi2Component FMI(Instance);

void *fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String place,
                      const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean on)
{
    (void)name; (void)place; (void)callbacks; (void)visible; (void)on;
    return type == fmi2ModelExchange ? made(token) : NULL;
}
Status fmi2SetupExperiment(OF, Truth a, double b, double start, Truth c, double stop)
{
    (void)a; (void)b; (void)c; (void)stop;
    IT->time = start;
    return fmi2OK;
}
Status fmi2EnterInitializationMode(OF) { (void)instance; return fmi2OK; }
Status fmi2ExitInitializationMode(OF) { return ready(IT); }
Status fmi2GetReal(OF, const Reference *at, size_t n, double *v) { return get(IT, at, n, v); }
Status fmi2SetReal(OF, const Reference *at, size_t n, const double *v) { return set(IT, at, n, v); }
Status fmi2NewDiscreteStates(OF, fmi2EventInfo *info)
{
    if (!IT->event) return fmi2Error;
    double next = update(IT);
    *info = (fmi2EventInfo){false, false, false, true, next >= 0.0, next};
    return fmi2OK;
}
Status fmi2CompletedIntegratorStep(OF, Truth a, Truth *event, Truth *ends)
{
    (void)a; (void)instance;
    *event = *ends = false;
    return fmi2OK;
}
Status fmi2GetDerivatives(OF, double *d, size_t n) { (void)n; rates(IT->r, d); return fmi2OK; }
Status fmi2GetFMUstate(OF, void **state)
{
    if (!*state) *state = malloc(sizeof(Instance));
    memcpy(*state, IT, sizeof(Instance));
    return fmi2OK;
}
Status fmi2SetFMUstate(OF, void *state) { memcpy(IT, state, sizeof(Instance)); return fmi2OK; }
Status fmi2FreeFMUstate(OF, void **state) { (void)instance; free(*state); *state = NULL; return 0; }
#else
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String place,
                                          Truth visible, Truth on, fmi3InstanceEnvironment host,
                                          fmi3LogMessageCallback log)
{
    (void)name; (void)place; (void)visible; (void)on; (void)host; (void)log;
    return made(token);
}
Status fmi3EnterInitializationMode(OF, Truth a, double b, double start, Truth c, double stop)
{
    (void)a; (void)b; (void)c; (void)stop;
    IT->time = start;
    return fmi3OK;
}
Status fmi3ExitInitializationMode(OF) { return ready(IT); }
Status fmi3GetFloat64(OF, const Reference *at, size_t n, double *v, size_t m)
{
    return m == n ? get(IT, at, n, v) : fmi3Error;
}
Status fmi3SetFloat64(OF, const Reference *at, size_t n, const double *v, size_t m)
{
    return m == n ? set(IT, at, n, v) : fmi3Error;
}
Status fmi3UpdateDiscreteStates(OF, Truth *again, Truth *ends, Truth *nominals, Truth *values,
                                Truth *defined, double *next)
{
    if (!IT->event) return fmi3Error;
    *again = *ends = *nominals = false;
    *values = true;
    *next = update(IT);
    *defined = *next >= 0.0;
    return fmi3OK;
}
Status fmi3CompletedIntegratorStep(OF, Truth a, Truth *event, Truth *ends)
{
    (void)a; (void)instance;
    *event = *ends = false;
    return fmi3OK;
}
Status fmi3GetContinuousStateDerivatives(OF, double *d, size_t n)
{
    (void)n;
    rates(IT->r, d);
    return fmi3OK;
}
Status fmi3GetNumberOfContinuousStates(OF, size_t *n) { (void)instance; *n = STATES; return fmi3OK; }
Status fmi3GetNumberOfEventIndicators(OF, size_t *n) { (void)instance; *n = INDICATORS; return 0; }
Status fmi3GetFMUState(OF, void **state)
{
    if (!*state) *state = malloc(sizeof(Instance));
    memcpy(*state, IT, sizeof(Instance));
    return fmi3OK;
}
Status fmi3SetFMUState(OF, void *state) { memcpy(IT, state, sizeof(Instance)); return fmi3OK; }
Status fmi3FreeFMUState(OF, void **state) { (void)instance; free(*state); *state = NULL; return 0; }
#endif

Status FMI(EnterEventMode)(OF) { return mode(IT, true); }
Status FMI(EnterContinuousTimeMode)(OF) { return mode(IT, false); }
Status FMI(SetTime)(OF, double time) { IT->time = time; return FMI(OK); }
Status FMI(GetContinuousStates)(OF, double *x, size_t n)
{
    for (size_t k = 0; k < n; k++) x[k] = IT->r[STATE[k]];
    return FMI(OK);
}
Status FMI(SetContinuousStates)(OF, const double *x, size_t n)
{
    if (IT->event) return FMI(Error);
    for (size_t k = 0; k < n; k++) IT->r[STATE[k]] = x[k];
    return FMI(OK);
}
Status FMI(GetNominalsOfContinuousStates)(OF, double *x, size_t n)
{
    (void)instance;
    for (size_t k = 0; k < n; k++) x[k] = 1.0;
    return FMI(OK);
}
Status FMI(GetEventIndicators)(OF, double *z, size_t n)
{
    (void)instance; (void)z; (void)n;
#ifdef MODEL_BALL
    z[0] = IT->r[H];
#endif
    return FMI(OK);
}
Status FMI(Terminate)(OF) { (void)instance; return FMI(OK); }
void FMI(FreeInstance)(OF) { free(instance); }
