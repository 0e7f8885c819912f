/* Fixed steps from point to point, cut at discontinuities; follows stepping.py and stepper.py. */
#include <math.h>
#include <time.h>

#include "loop.h"

enum { LOOK = 32 };  /* steps between two looks at the clock */

double now(void) {
    struct timespec moment;
    timespec_get(&moment, TIME_UTC);
    return (double)moment.tv_sec + 1e-9 * (double)moment.tv_nsec;
}

static double point(const Run *run, int64_t k) {
    if (run->points) return run->points[k];
    return k == run->count ? run->stop : run->start + (double)k * run->step;
}

/* Where a step has to end at the latest. */
double cut(const System *system, const Run *run, double time, double end) {
    double stop;
    if (run->whole) return end;
    stop = next_event(system);
    if (run->next_action < stop) stop = run->next_action;
    return time + run->margin < stop && stop < end - run->margin ? stop : end;
}

/* One step of the master; then what is due at its end. `ACTION` where Python has to act. */
static int step(System *system, Master *master, Run *run, double time, double end, double size) {
    double event = next_event(system);
    int code = advance(system, master, run, time, size);
    if (code) return code;
    run->steps++;
    if (event <= end + run->margin) interrupt_master(master);
    return run->next_action <= end + run->margin ? ACTION : 0;
}

/* From run->time to run->end in pieces. `within` is 1 while pieces are left, 2 once none is. */
static int to(System *system, Master *master, Run *run) {
    int code;
    if (run->quiet) {
        code = advance(system, master, run, run->time, run->size);
        if (code) return code;
        run->steps++;
        run->within = 2;
        return 0;
    }
    while (run->within == 1) {
        double stop = cut(system, run, run->time, run->end);
        double time = run->time, size = stop == run->end ? run->size : stop - time;
        code = step(system, master, run, time, stop, size);
        if (code && code != ACTION) return code;
        if (stop == run->end) {
            run->within = 2;
        } else {
            run->time = stop;
            run->size = run->end - stop;
        }
        if (code) return code;
    }
    return 0;
}

static int sample(System *system, Guard *guard, Recorder *recorder, Audit *audit, Run *run) {
    int code = guard_sample(guard, system);
    if (code) return code;
    record(recorder, system, run->index + 1, run->end);
    return audit->count ? audit_sample(audit, system, run->end, run) : 0;
}

int resilin_run(System *system, Master *master, Guard *guard, Recorder *recorder, Audit *audit,
                Run *run) {
    double begun = now();
    int64_t looked = 0;
    int code;
    while (run->index < run->count) {
        if (!run->within) {
            double time = point(run, run->index), end = point(run, run->index + 1);
            if (recorder->count == recorder->capacity) return FULL;
            run->time = time;
            run->end = end;
            run->size = run->points || run->index + 1 == run->count ? end - time : run->step;
            run->within = 1;
        }
        code = to(system, master, run);
        if (code) return code;
        code = sample(system, guard, recorder, audit, run);
        if (code) return code;
        run->within = 0;
        run->index++;
        if (++looked % LOOK == 0 && now() - begun > run->patience) return PAUSE;
    }
    return DONE;
}
