/* Masters: gauss_seidel.py, jacobi.py, extrapolated.py with extrapolation.py. */
#include <string.h>

#include "loop.h"

static int step_and_receive(System *system, Instance *instance, Run *run, double time, double size) {
    int status = step_instance(instance, time, size);
    if (status) return failed(run, system, instance, STEP, status, time, size);
    status = receive(instance, 0);
    if (status) return failed(run, system, instance, RECEIVE, status, time, size);
    return 0;
}

static int gather_or_fail(System *system, Instance *instance, Run *run, double time, double size) {
    int status = gather(instance);
    return status ? failed(run, system, instance, SEND, status, time, size) : 0;
}

static int gauss_seidel(System *system, Run *run, double time, double size) {
    for (int64_t k = 0; k < system->instance_count; k++) {
        Instance *instance = &system->instances[k];
        int code = gather_or_fail(system, instance, run, time, size);
        if (code || (code = step_and_receive(system, instance, run, time, size))) return code;
    }
    return follow(system, run);
}

static int jacobi(System *system, Run *run, double time, double size) {
    int code;
    for (int64_t k = 0; k < system->instance_count; k++)
        if ((code = gather_or_fail(system, &system->instances[k], run, time, size))) return code;
    for (int64_t k = 0; k < system->instance_count; k++)
        if ((code = step_and_receive(system, &system->instances[k], run, time, size))) return code;
    return follow(system, run);
}

/* Integral over [0, 1] of the polynomial that is 1 at node `j` and 0 at the others. */
static double mean_of_basis(const double *nodes, int64_t count, int64_t j) {
    double coefficients[POINTS + 1] = {1.0};
    double below = 1.0, total = 0.0;
    int64_t degree = 0;
    for (int64_t i = 0; i < count; i++) {
        if (i == j) continue;
        coefficients[degree + 1] = coefficients[degree];
        for (int64_t k = degree; k > 0; k--)
            coefficients[k] = coefficients[k - 1] - nodes[i] * coefficients[k];
        coefficients[0] = -nodes[i] * coefficients[0];
        degree++;
        below = below * (nodes[j] - nodes[i]);
    }
    for (int64_t k = 0; k <= degree; k++) total = total + coefficients[k] / (double)(k + 1);
    return total / below;
}

void mean_weights(const double *times, int64_t count, double begin, double end, double *weights) {
    double nodes[POINTS];
    for (int64_t k = 0; k < count; k++) nodes[k] = (times[k] - begin) / (end - begin);
    for (int64_t k = 0; k < count; k++) weights[k] = mean_of_basis(nodes, count, k);
}

void point_weights(const double *times, int64_t count, double at, double scale, double *weights) {
    double nodes[POINTS];
    for (int64_t k = 0; k < count; k++) nodes[k] = (times[k] - at) / scale;
    for (int64_t j = 0; j < count; j++) {
        double above = 1.0, below = 1.0;
        for (int64_t i = 0; i < count; i++) {
            if (i == j) continue;
            above = above * -nodes[i];
            below = below * (nodes[j] - nodes[i]);
        }
        weights[j] = above / below;
    }
}

/* Take in a communication point; one that was there already is replaced. With `places` only the
 * values there are kept. */
void note(Past *past, double time, const double *values, const int64_t *places, int64_t count) {
    int again = past->count && past->times[0] == time;
    if (!again) {
        double *oldest = past->values[past->most - 1];
        if (past->count < past->most) past->count++;
        for (int64_t k = past->most - 1; k > 0; k--) {
            past->values[k] = past->values[k - 1];
            past->times[k] = past->times[k - 1];
        }
        past->values[0] = oldest;
    }
    past->times[0] = time;
    for (int64_t k = 0; k < count; k++) past->values[0][k] = values[places ? places[k] : k];
}

void copy_past(Past *into, const Past *from, int64_t count) {
    into->count = from->count;
    for (int64_t k = 0; k < from->count; k++) {
        into->times[k] = from->times[k];
        memcpy(into->values[k], from->values[k], (size_t)count * sizeof(double));
    }
}

void combine(const double *weights, double *const *values, int64_t points, int64_t count,
             double *total) {
    for (int64_t k = 0; k < count; k++) total[k] = weights[0] * values[0][k];
    for (int64_t p = 1; p < points; p++)
        for (int64_t k = 0; k < count; k++) total[k] = total[k] + weights[p] * values[p][k];
}

/* Wired inputs as their sources give them, the bare numbers among them from elsewhere. */
static int gather_plain(System *system, const Master *master, Instance *instance, int at_end,
                        double weight) {
    const double *values = system->values;
    for (int64_t k = 0; k < instance->wired; k++)
        instance->arriving[k] = values[instance->sources[k]];
    for (int64_t k = 0; k < instance->plain_count; k++) {
        int64_t place = instance->sources[instance->plain[k]];
        double number;
        if (at_end)
            number = master->stepped[place] ? values[place] : master->last[place];
        else
            number = master->stepped[place] ? weight * values[place] + master->before[place]
                                            : master->mean[place];
        instance->arriving[instance->plain[k]] = number;
    }
    memcpy(instance->inputs, instance->arriving, (size_t)instance->wired * sizeof(double));
    return pass_on(instance, 1);
}

static int extrapolated(System *system, Master *master, Run *run, double time, double size) {
    Past *past = &master->past;
    int64_t count = system->value_count;
    double end = time + size, known[POINTS + 1], weights[POINTS + 1];
    int64_t known_count;
    note(past, time, system->values, NULL, count);
    mean_weights(past->times, past->count, time, end, weights);
    combine(weights, past->values, past->count, count, master->mean);
    point_weights(past->times, past->count, end, size, weights);
    combine(weights, past->values, past->count, count, master->last);
    known[0] = end;
    memcpy(known + 1, past->times, (size_t)past->count * sizeof(double));
    known_count = past->count + 1 < master->degree + 1 ? past->count + 1 : master->degree + 1;
    mean_weights(known, known_count, time, end, weights);
    combine(weights + 1, past->values, known_count - 1, count, master->before);
    memset(master->stepped, 0, (size_t)count);
    for (int64_t k = 0; k < system->instance_count; k++) {
        Instance *instance = &system->instances[k];
        int status, code;
        if (instance->plain_count) {
            status = gather_plain(system, master, instance, 0, weights[0]);
            if (status) return failed(run, system, instance, SEND, status, time, size);
            status = step_instance(instance, time, size);
            if (status) return failed(run, system, instance, STEP, status, time, size);
            if (instance->direct) {
                status = gather_plain(system, master, instance, 1, 0.0);
                if (status) return failed(run, system, instance, SEND, status, time, size);
            }
            status = receive(instance, 0);
            if (status) return failed(run, system, instance, RECEIVE, status, time, size);
        } else {
            code = gather_or_fail(system, instance, run, time, size);
            if (code || (code = step_and_receive(system, instance, run, time, size))) return code;
        }
        memset(master->stepped + instance->first, 1, (size_t)(instance->past - instance->first));
    }
    return follow(system, run);
}

int advance(System *system, Master *master, Run *run, double time, double size) {
    if (master->kind == JACOBI) return jacobi(system, run, time, size);
    if (master->kind == EXTRAPOLATED) return extrapolated(system, master, run, time, size);
    return gauss_seidel(system, run, time, size);
}

void interrupt_master(Master *master) { master->past.count = 0; }
