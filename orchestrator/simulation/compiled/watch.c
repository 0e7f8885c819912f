/* What watches a run: guard and recorder of observers.py, energy_audit.py with port_laws.py. */
#include <math.h>
#include <string.h>

#include "loop.h"

#define NO_REFERENCE (-1e30)

double next_event(const System *system) {
    double first = INFINITY;
    for (int64_t k = 0; k < system->event_count; k++) {
        double time = system->values[system->events[k]];
        if (time < first) first = time;
    }
    return first;
}

int guard_sample(Guard *guard, const System *system) {
    const double *values = system->values;
    int64_t count = system->value_count;
    int found = 0;
    for (int64_t k = 0; k < count; k++)
        if (!(values[k] <= guard->high[k] && values[k] >= guard->low[k])) return OUT_OF_BOUNDS;
    if (!guard->every) return 0;
    for (int64_t k = 0; k < count; k++) {
        double size = fabs(values[k]);
        if (size > guard->peak[k]) guard->peak[k] = size;
    }
    if (++guard->count % guard->every) return 0;
    for (int64_t k = 0; k < count; k++) {
        int doubled = guard->peak[k] >= 2.0 * guard->previous[k] && guard->previous[k] > 0.0;
        guard->growing[k] = doubled && guard->wired[k] ? guard->growing[k] + 1 : 0;
        found |= guard->growing[k] >= guard->windows;
    }
    if (found) return GROWTH;
    memcpy(guard->previous, guard->peak, (size_t)count * sizeof(double));
    memset(guard->peak, 0, (size_t)count * sizeof(double));
    return 0;
}

void record(Recorder *recorder, const System *system, int64_t step, double time) {
    double *row;
    if (step % recorder->every || time < recorder->from) return;
    row = recorder->rows + recorder->count * recorder->column_count;
    for (int64_t k = 0; k < recorder->column_count; k++)
        ((volatile double *)row)[k] = system->values[recorder->columns[k]];
    /* Last, and kept there by the compiler: with its time a row is whole for who reads it. */
    *(volatile double *)&recorder->times[recorder->count] = time;
    recorder->count++;
}

/* Members of the laws, in the order in which layout.py gives their places. */
enum { VALUE, REFERENCE_TIME, REFERENCE_DISPLACEMENT, REFERENCE_VELOCITY, STIFFNESS, DAMPING, RATE,
       CURVATURE };
enum { DRAG_TORQUE, REFERENCE_RATE, DRAG, DRAG_SLOPE, LOAD_DAMPING };

static double member(const Coupling *c, int which, double missing) {
    return c->members[which] < 0 ? missing : c->inputs[c->members[which]];
}

static double law_at(const Coupling *c, const double *motion, double time) {
    if (c->law == FORCE) {
        double reference = member(c, REFERENCE_TIME, NO_REFERENCE);
        int none = reference <= 0.5 * NO_REFERENCE || reference == 0.0;
        double s = none ? 0.0 : time - reference;
        double x = motion[0] - member(c, REFERENCE_DISPLACEMENT, 0.0);
        double v = motion[1] - member(c, REFERENCE_VELOCITY, 0.0);
        double passive = member(c, STIFFNESS, 0.0) * x + member(c, DAMPING, 0.0) * v;
        double moved = (member(c, RATE, 0.0) + member(c, CURVATURE, 0.0) * s) * s;
        return member(c, VALUE, 0.0) - passive + moved;
    } else {
        double w = motion[2], w0 = member(c, REFERENCE_RATE, 0.0);
        double drag = member(c, DRAG, 0.0);
        double sloped = drag + member(c, DRAG_SLOPE, 0.0) * (w - w0);
        double now = sloped > 0.0 ? sloped : 0.0;
        double passive = member(c, LOAD_DAMPING, 0.0) * (w - w0);
        return member(c, DRAG_TORQUE, 0.0) - passive - now * w * fabs(w) + drag * w0 * fabs(w0);
    }
}

static void add(Coupling *c, const System *system, double time) {
    const double *values = system->values;
    double then = c->last[0], effort = c->last[1], flow = c->last[2], earlier = c->last[3];
    double size = time - then, work;
    double now = values[c->effort] * c->scale, moving = values[c->flow];
    if (c->law == NO_LAW) {
        double sent = c->inputs[c->members[VALUE]];
        double middle = 0.375 * now + 0.75 * effort - 0.125 * earlier;
        work = (sent - effort) * flow + 4.0 * (sent - middle) * 0.5 * (flow + moving);
        work = (work + (sent - now) * moving) / 6.0;
    } else {
        double motion[MOTIONS];
        double first, last;
        for (int k = 0; k < MOTIONS; k++) motion[k] = c->back[k] < 0 ? 0.0 : values[c->back[k]];
        first = law_at(c, c->motion, then) - effort;
        last = law_at(c, motion, time) - now;
        work = c->share * (first * flow + last * moving);
        memcpy(c->motion, motion, sizeof motion);
    }
    c->created += work * size;
    c->exchanged += 0.5 * size * (fabs(effort * flow) + fabs(now * moving));
    c->last[0] = time;
    c->last[1] = now;
    c->last[2] = moving;
    c->last[3] = effort;
}

/* Created or exchanged energy `back` samples ago. */
static double past(const Coupling *c, int64_t back, int which) {
    return c->history[2 * ((c->kept - 1 - back) % HISTORY) + which];
}

static int fed(const Audit *audit, const Coupling *c) {
    static const int64_t spans[SPANS] = {8, 16, 32, 64, 128, 256, 512, 1024, 2048};
    int64_t length = c->kept < HISTORY ? c->kept : HISTORY;
    for (int s = 0; s < SPANS; s++) {
        int64_t span = spans[s], quarter = span / 4;
        double first, since = 1.0, needed, parts[4], growth[3], created, exchanged;
        double least = INFINITY, low = INFINITY, high = -INFINITY;
        if (length <= span) break;
        first = past(c, span - quarter, 1) - past(c, span, 1);
        if (span < audit->brief) {
            double left = (double)c->age - 0.875 * (double)span;
            since = ((double)c->age - 0.125 * (double)span) / (left > 1.0 ? left : 1.0);
        }
        needed = pow(since, audit->power);
        if (!(needed > audit->rise)) needed = audit->rise;
        if (past(c, 0, 1) - past(c, quarter, 1) < needed * first) continue;
        for (int k = 0; k < 4; k++) {
            parts[k] = past(c, span - (k + 1) * quarter, 1) - past(c, span - k * quarter, 1);
            if (parts[k] < least) least = parts[k];
        }
        if (least <= 0.0) continue;
        for (int k = 0; k < 3; k++) {
            growth[k] = log(parts[k + 1] / parts[k]);
            if (growth[k] < low) low = growth[k];
            if (growth[k] > high) high = growth[k];
        }
        created = past(c, 0, 0) - past(c, span, 0);
        exchanged = past(c, 0, 1) - past(c, span, 1);
        if (low >= audit->even * high &&
            created >= (span < audit->brief ? audit->blatant : audit->fed) * exchanged &&
            exchanged >= fmax(audit->faint, 0.5 * past(c, 0, 1)))
            return (int)span;
    }
    return 0;
}

int audit_sample(Audit *audit, const System *system, double time, Run *run) {
    for (int64_t k = 0; k < audit->count; k++) add(&audit->couplings[k], system, time);
    for (int64_t k = 0; k < audit->count; k++) {
        Coupling *c = &audit->couplings[k];
        int64_t slot = 2 * (c->kept % HISTORY);
        c->age += c->exchanged > 0.0;
        c->history[slot] = c->created;
        c->history[slot + 1] = c->exchanged;
        c->kept++;
    }
    if (++audit->steps % audit->checked) return 0;
    for (int64_t k = 0; k < audit->count; k++) {
        int span = fed(audit, &audit->couplings[k]);
        if (span) {
            run->place = (int32_t)k;
            run->status = span;
            return CREATED;
        }
    }
    return 0;
}
