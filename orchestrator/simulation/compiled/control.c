/* Steps of a size that an error estimate finds; follows step_control.py. */
#include <math.h>
#include <string.h>

#include "loop.h"

#define LEAST_SHARE 0.03
#define MILNE (1.0 / 6.0)
enum { FATAL_STATUS = 4 };

static int on_all(System *system, Control *control, Run *run, int what) {
    for (int64_t k = 0; k < system->instance_count; k++) {
        Instance *instance = &system->instances[k];
        void **state = &control->kept_states[k];
        int status = what == SAVE      ? save_state(instance, state)
                     : what == RESTORE ? restore_state(instance, *state)
                                       : forget_state(instance, state);
        if (status) return failed(run, system, instance, what, status, run->time, 0.0);
        if (what == SAVE)
            memcpy(control->kept_inputs[k], instance->inputs,
                   (size_t)control->input_counts[k] * sizeof(double));
        else if (what == RESTORE)
            memcpy(instance->inputs, control->kept_inputs[k],
                   (size_t)control->input_counts[k] * sizeof(double));
    }
    return 0;
}

static int keep(System *system, Master *master, Control *control, Run *run) {
    memcpy(control->kept_values, system->values, (size_t)system->value_count * sizeof(double));
    if (master->kind == EXTRAPOLATED)
        copy_past(&control->kept_past, &master->past, system->value_count);
    return on_all(system, control, run, SAVE);
}

static int go_back(System *system, Master *master, Control *control, Run *run) {
    memcpy(system->values, control->kept_values, (size_t)system->value_count * sizeof(double));
    if (master->kind == EXTRAPOLATED)
        copy_past(&master->past, &control->kept_past, system->value_count);
    return on_all(system, control, run, RESTORE);
}

/* Free the states that are kept: once, after the run. */
int resilin_forget(System *system, Control *control, Run *run) {
    return control->doubling ? on_all(system, control, run, FORGET) : 0;
}

/* The step once whole and once in halves; the halves are kept. */
static int doubled(System *system, Master *master, Control *control, Run *run, double time,
                   double size) {
    double half = 0.5 * size, middle = time + half;
    int code = advance(system, master, run, time, size);
    if (code) return code;
    for (int64_t k = 0; k < control->column_count; k++)
        control->whole[k] = system->values[control->columns[k]];
    if ((code = go_back(system, master, control, run))) return code;
    if ((code = advance(system, master, run, time, half))) return code;
    if ((code = advance(system, master, run, middle, time + size - middle))) return code;
    run->steps += 3;
    for (int64_t k = 0; k < control->column_count; k++)
        control->error[k] = fabs(control->whole[k] - system->values[control->columns[k]]);
    return 0;
}

/* What a parabola through the last points has foreseen against what came. */
static int foreseen(System *system, Master *master, Control *control, Run *run, double time,
                    double size) {
    double end = time + size, weights[POINTS];
    int code;
    note(&control->seen, time, system->values, control->columns, control->column_count);
    if ((code = advance(system, master, run, time, size))) return code;
    run->steps++;
    point_weights(control->seen.times, control->seen.count, end, size, weights);
    combine(weights, control->seen.values, control->seen.count, control->column_count,
            control->whole);
    for (int64_t k = 0; k < control->column_count; k++)
        control->error[k] =
            MILNE * fabs(control->whole[k] - system->values[control->columns[k]]);
    return 0;
}

/* Largest error relative to the largest value seen; not a number where any error is not. */
static double largest_miss(const System *system, Control *control) {
    double miss = 0.0;
    for (int64_t k = 0; k < control->column_count; k++) {
        double size = fabs(system->values[control->columns[k]]), relative;
        if (size > control->scale[k] || isnan(size)) control->scale[k] = size;
        relative = control->error[k] / (control->scale[k] + 1e-300);
        if (isnan(relative) || isnan(miss)) miss = NAN;
        else if (relative > miss) miss = relative;
    }
    return miss;
}

static double clipped(double size, double least, double most) {
    if (size < least) size = least;
    return size > most ? most : size;
}

/* PI control: whether a step is good enough (-1: neither that nor to be repeated). */
static int judge(Control *control, double miss, double size) {
    double share = control->tolerance, ratio, factor;
    if (control->span > 0.0) {
        double part = size / control->span;
        share *= part > LEAST_SHARE ? part : LEAST_SHARE;
    }
    ratio = miss / share;
    if (1e-6 > ratio) ratio = 1e-6;
    if (!isfinite(ratio)) {
        if (!control->doubling) return -1;
        control->next = 0.2 * size > control->least ? 0.2 * size : control->least;
        return 0;
    }
    if (control->doubling && ratio > 1.0 && size > control->least * (1.0 + 1e-6)) {
        factor = 0.9 * pow(ratio, -1.0 / control->order);
        if (!(factor > 0.2)) factor = 0.2;
        control->before = 1.0;
        control->next = size * factor > control->least ? size * factor : control->least;
        return 0;
    }
    factor = 0.9 * pow(ratio, -0.7 / control->order) * pow(control->before, 0.4 / control->order);
    control->before = ratio;
    factor = factor > 0.2 ? factor : 0.2;
    factor = factor < 4.0 ? factor : 4.0;
    control->next = clipped(size * factor, control->least, control->most);
    return 1;
}

static int switched(const System *system, const Control *control) {
    for (int64_t k = 0; k < control->switch_count; k++) {
        int64_t place = control->switches[k];
        if (system->values[place] != control->kept_values[place]) return 1;
    }
    return 0;
}

/* Whether a step with a switch has moved a value by more than the tolerance. */
static int late(const System *system, const Control *control, double size) {
    if (size <= control->least * (1.0 + 1e-6) || !switched(system, control)) return 0;
    for (int64_t k = 0; k < control->column_count; k++) {
        int64_t place = control->columns[k];
        double moved = fabs(system->values[place] - control->kept_values[place]);
        if (moved / (control->scale[k] + 1e-300) > control->tolerance) return 1;
    }
    return 0;
}

/* What switch_location.py makes of a step that is good enough by its error. */
static int locate(const System *system, Master *master, Control *control, double size, double end) {
    double left, half;
    if (late(system, control, size)) {
        control->before = 1.0;
        control->next = 0.5 * size > control->least ? 0.5 * size : control->least;
        control->latest = end;
        return 0;
    }
    if (switched(system, control)) {
        control->latest = INFINITY;
        interrupt_master(master);
        return 1;
    }
    left = control->latest - end;
    if (left <= control->least) {
        control->latest = INFINITY;
        return 1;
    }
    half = 0.5 * left > control->least ? 0.5 * left : control->least;
    if (half < control->next) control->next = half;
    return 1;
}

/* End of a step of about `size`, so that no short rest is left before `latest`. */
static double end_of(double time, double size, double latest) {
    double left = latest - time;
    if (left <= 1.01 * size) return latest;
    return time + (left < 2.0 * size ? 0.5 * left : size);
}

/* What follows an accepted step, once timed actions that were due have been done. */
static int accepted(System *system, Master *master, Guard *guard, Recorder *recorder,
                    Control *control, Run *run) {
    int code;
    if (control->event <= run->end && !control->doubling) {
        control->seen.count = 0;
        if (control->first < control->next) control->next = control->first;
    }
    if (control->doubling) {
        if ((code = on_all(system, control, run, FORGET))) return code;
        if ((code = keep(system, master, control, run))) return code;
    }
    control->arrived = 0;
    run->index = control->taken_count - 1;
    if ((code = guard_sample(guard, system))) return code;
    record(recorder, system, run->index, run->end);
    return 0;
}

int resilin_run_controlled(System *system, Master *master, Guard *guard, Recorder *recorder,
                           Control *control, Run *run) {
    double begun = now();
    int64_t looked = 0;
    int code;
    if (control->doubling && !run->within) {
        run->within = 1;
        if ((code = keep(system, master, control, run))) return code;
    }
    if (control->arrived && (code = accepted(system, master, guard, recorder, control, run)))
        return code;
    while (run->time < run->stop) {
        double time = run->time, end, miss;
        int good;
        if (recorder->count == recorder->capacity) return FULL;
        if (control->taken_count + 2 > control->taken_capacity) return FULL;
        end = end_of(time, control->next, cut(system, run, time, run->stop));
        control->event = next_event(system);
        run->end = end;
        code = control->doubling ? doubled(system, master, control, run, time, end - time)
                                 : foreseen(system, master, control, run, time, end - time);
        if (code) {
            double least = control->least + 4.0 * (nextafter(end, INFINITY) - end);
            if (!control->doubling || end - time <= least || run->status >= FATAL_STATUS)
                return code;
            miss = INFINITY;
        } else {
            miss = largest_miss(system, control);
        }
        good = judge(control, miss, end - time);
        if (good < 0) return NOT_FINITE;
        if (good && control->doubling) good = locate(system, master, control, end - time, end);
        run->time = time;
        if (!good) {
            if ((code = go_back(system, master, control, run))) return code;
            control->rejected++;
            continue;
        }
        if (control->doubling)
            control->taken[control->taken_count++] = time + 0.5 * (end - time);
        control->taken[control->taken_count++] = end;
        run->time = end;
        control->arrived = 1;
        if (control->event <= end + run->margin) interrupt_master(master);
        if (run->next_action <= end + run->margin) return ACTION;
        if ((code = accepted(system, master, guard, recorder, control, run))) return code;
        if (++looked % 16 == 0 && now() - begun > run->patience) return PAUSE;
    }
    return DONE;
}
