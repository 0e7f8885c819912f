/* The communication loop in C: what Python lays out in layout.py, and what the loop reports back.
 *
 * Python owns every array. The structures below hold pointers into the arrays of the system, its
 * instances and its observers, so that both sides see the same numbers at any time. The loop takes
 * the same steps, with the same arithmetic in the same order, as the Python files that it follows:
 * rows are equal to the bit (tests/orchestrator/simulation/compiled).
 */
#ifndef RESILIN_LOOP_H
#define RESILIN_LOOP_H

#include <stddef.h>
#include <stdint.h>

/* Why the loop has returned. */
enum {
    DONE = 0,       /* the last point is reached */
    PAUSE = 1,      /* time for Python to look at signals and progress */
    FULL = 2,       /* no room for another row */
    ACTION = 3,     /* a timed action is due */
    CALL_FAILED = 4,/* an instance: see `place`, `phase`, `status`, `time`, `size` */
    OUT_OF_BOUNDS = 5, /* the guard: a value has left its bounds, or is not a number */
    GROWTH = 6,     /* the guard: a wired value doubles window after window */
    CREATED = 7,    /* the audit: coupling `place` feeds a growth, over `status` steps */
    NOT_FINITE = 8  /* step control: an error that is not finite and no way back */
};

/* What was asked of an instance that failed, or is asked of one that Python serves. */
enum { SEND = 0, STEP = 1, RECEIVE_FIRST = 2, RECEIVE = 3, SAVE = 4, RESTORE = 5, FORGET = 6,
       REFUSED = 7, BEYOND = 8 };

/* Types of the values that travel. */
enum { F64 = 0, F32 = 1, I8 = 2, U8 = 3, I16 = 4, U16 = 5, I32 = 6, U32 = 7, I64 = 8, U64 = 9,
       BOOLEAN = 10 };

enum { GAUSS_SEIDEL = 0, JACOBI = 1, EXTRAPOLATED = 2 };
enum { NO_LAW = 0, FORCE = 1, TORQUE = 2 };
enum { POINTS = 4, SPANS = 9, HISTORY = 2049, MEMBERS = 8, MOTIONS = 3 };

/* Variables of one FMI type that are set or got by one call. */
typedef struct {
    void *call;                /* fmi2SetReal, fmi3GetFloat64, ... */
    const uint32_t *references;
    void *values;              /* what the FMU reads or writes: the buffer, or staging of its type */
    const int64_t *places;     /* where elements stand in staging; null where it is the buffer */
    const int64_t *indices;    /* where they stand in the buffer */
    int64_t reference_count, value_count, used;
    int32_t type, wide;        /* `wide`: whole numbers that a double may not hold */
} Block;

typedef struct {
    const Block *blocks;
    int64_t count;
    double *buffer;
} Transfer;

typedef struct {
    double *target;
    const double *source;
    int64_t count;
} Move;

/* Where an instance is, for a process that watches: fmi/instance/place.py. */
typedef struct {
    volatile int64_t turns, steps, rollbacks; /* `turns` is odd amid a call */
    volatile double time, size;
    volatile int32_t call;
} Place;

/* An instance in its place, as in coupled_instance.py. */
typedef struct {
    void *component;
    void *do_step, *get_state, *set_state, *free_state;
    int (*serve)(int32_t what, double time, double size); /* Python's, where version is 0 */
    const Move *moves;
    double *inputs;
    const double *gain, *offset;       /* null where nothing is scaled */
    const int64_t *sources, *plain;    /* places of wired inputs; which come as bare numbers */
    double *arriving;                  /* scratch for the wired inputs */
    int32_t *faults;                   /* error messages logged since the start */
    uint8_t *flags[3];                 /* FMI 3: event, terminate, early return */
    double *reached;
    Place *place;                      /* null where nobody watches */
    Transfer set, get[2];              /* get[0]: what later instances need; get[1]: everything */
    int64_t move_count, wired, plain_count;
    int64_t first, past;               /* stretch of the system's values */
    int64_t steps, rollbacks, saved, warned;
    double now, kept;                  /* its time; that of the oldest state which is saved */
    int32_t version, direct;
} Instance;

typedef struct {
    double *values;
    Instance *instances;
    const int32_t *followers;
    const int64_t *events;
    int64_t value_count, instance_count, follower_count, event_count;
} System;

/* Values at the last points, newest first, as in extrapolation.py. */
typedef struct {
    double *values[POINTS];
    double times[POINTS];
    int64_t count, most;
} Past;

typedef struct {
    int32_t kind, degree;
    Past past;
    double *mean, *last, *before;
    uint8_t *stepped;
} Master;

typedef struct {
    const double *high, *low;
    const uint8_t *wired;
    double *peak, *previous;
    int64_t *growing;
    int64_t every, windows, count;     /* every 0: growth is not watched */
} Guard;

typedef struct {
    const int64_t *columns;
    double *rows, *times;
    int64_t column_count, every, count, capacity;
    double from;
} Recorder;

/* One watched coupling, as in energy_audit.py; places of members that are not wired are -1. */
typedef struct {
    const double *inputs;              /* of the receiver */
    double *history;                   /* pairs of created and exchanged, a ring */
    int64_t members[MEMBERS], back[MOTIONS];
    int64_t effort, flow, age, kept;
    double scale, share, created, exchanged;
    double last[4], motion[MOTIONS];
    int32_t law;
} Coupling;

typedef struct {
    Coupling *couplings;
    int64_t count, checked, steps;
    double growth, rise, power, even, fed, blatant, faint;
    int64_t brief;
} Audit;

/* Step control, as in step_control.py: an estimator, a controller, and the last point kept. */
typedef struct {
    const int64_t *columns;            /* coupling values whose error counts */
    double *whole, *error, *scale;     /* of those, in their order */
    double *kept_values;               /* the last accepted point: values, inputs, states, past */
    const int64_t *switches;           /* wired values that switch, as in switch_location.py */
    double **kept_inputs;
    const int64_t *input_counts;
    void **kept_states;
    Past kept_past, seen;
    double *taken;                     /* communication points so far */
    int64_t column_count, switch_count, taken_count, taken_capacity, rejected;
    double tolerance, span, order, most, least, before, first;
    double next, event;                /* size of the next step; event announced before the last */
    double latest;                     /* end of a step with a switch, infinity where none is sought */
    int32_t doubling, arrived;
} Control;

/* Where the loop stands, and why it has returned. */
typedef struct {
    const double *points;              /* given points; null for the grid */
    double start, stop, step, margin;
    double next_action;                /* infinity without one */
    double time, end, size;            /* of the step in hand, and of the call that failed */
    int64_t count, index, steps;
    int32_t within, whole, quiet, place, phase, status;
    double patience;                   /* seconds until the loop returns for a pause */
} Run;

__attribute__((visibility("default")))
int resilin_run(System *system, Master *master, Guard *guard, Recorder *recorder, Audit *audit,
                Run *run);

__attribute__((visibility("default")))
int resilin_run_controlled(System *system, Master *master, Guard *guard, Recorder *recorder,
                           Control *control, Run *run);
__attribute__((visibility("default")))
int resilin_forget(System *system, Control *control, Run *run);

/* instance.c */
int gather(Instance *instance);
int pass_on(Instance *instance, int scaled);
int step_instance(Instance *instance, double time, double size);
int receive(Instance *instance, int group);
int save_state(Instance *instance, void **state);
int restore_state(Instance *instance, void *state);
int forget_state(Instance *instance, void **state);
int follow(System *system, Run *run);
int failed(Run *run, const System *system, const Instance *instance, int phase, int status,
           double time, double size);

/* master.c */
int advance(System *system, Master *master, Run *run, double time, double size);
void interrupt_master(Master *master);
void note(Past *past, double time, const double *values, const int64_t *places, int64_t count);
void copy_past(Past *into, const Past *from, int64_t count);
void combine(const double *weights, double *const *values, int64_t points, int64_t count,
             double *total);
void point_weights(const double *times, int64_t count, double at, double scale, double *weights);
void mean_weights(const double *times, int64_t count, double begin, double end, double *weights);

/* watch.c */
int guard_sample(Guard *guard, const System *system);
void record(Recorder *recorder, const System *system, int64_t step, double time);
int audit_sample(Audit *audit, const System *system, double time, Run *run);
double next_event(const System *system);

/* loop.c */
double now(void);
double cut(const System *system, const Run *run, double time, double end);

#endif
