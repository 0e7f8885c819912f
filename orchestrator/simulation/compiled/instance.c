/* Instances: inputs gathered and set, steps taken, outputs read. Follows coupled_instance.py and
 * fmi/instance/buffers.py. */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "loop.h"

/* Share of a step by which times of one communication point differ at most, by rounding. */
#define PRESENT 1e-6

typedef int (*Fmi2Transfer)(void *, const uint32_t *, size_t, void *);
typedef int (*Fmi3Transfer)(void *, const uint32_t *, size_t, void *, size_t);
typedef int (*Fmi2Step)(void *, double, double, int);
typedef int (*Fmi3Step)(void *, double, double, bool, uint8_t *, uint8_t *, uint8_t *, double *);
typedef int (*StateCall)(void *, void *);

enum { REFUSED_STATUS = 100, BEYOND_STATUS = 101 };
#define EXACT 9007199254740991.0

#define STAGE(TYPE, ROUND) \
    for (int64_t k = 0; k < block->used; k++) \
        ((TYPE *)block->values)[block->places[k]] = (TYPE)ROUND(buffer[block->indices[k]]); \
    break
#define TAKE(TYPE) \
    for (int64_t k = 0; k < block->used; k++) \
        buffer[block->indices[k]] = (double)((const TYPE *)block->values)[block->places[k]]; \
    break

/* Numbers into an array of the FMU's type; for whole types the nearest whole one. */
static void stage(const Block *block, const double *buffer) {
    switch (block->type) {
    case F64: STAGE(double, );
    case F32: STAGE(float, );
    case I8: STAGE(int8_t, rint);
    case U8: STAGE(uint8_t, rint);
    case I16: STAGE(int16_t, rint);
    case U16: STAGE(uint16_t, rint);
    case I32: STAGE(int32_t, rint);
    case U32: STAGE(uint32_t, rint);
    case I64: STAGE(int64_t, rint);
    case U64: STAGE(uint64_t, rint);
    default:
        for (int64_t k = 0; k < block->used; k++)
            ((uint8_t *)block->values)[block->places[k]] = rint(buffer[block->indices[k]]) != 0.0;
    }
}

/* Whether every whole number of a block is held by a double. */
static int exact(const Block *block) {
    for (int64_t k = 0; k < block->used; k++) {
        int64_t place = block->places[k];
        if (block->type == I64) {
            int64_t value = ((const int64_t *)block->values)[place];
            if (value > (int64_t)EXACT || value < -(int64_t)EXACT) return 0;
        } else if (((const uint64_t *)block->values)[place] > (uint64_t)EXACT) {
            return 0;
        }
    }
    return 1;
}

static void take(const Block *block, double *buffer) {
    switch (block->type) {
    case F64: TAKE(double);
    case F32: TAKE(float);
    case I8: TAKE(int8_t);
    case I16: TAKE(int16_t);
    case U16: TAKE(uint16_t);
    case I32: TAKE(int32_t);
    case U32: TAKE(uint32_t);
    case I64: TAKE(int64_t);
    case U64: TAKE(uint64_t);
    default: TAKE(uint8_t);
    }
}

static int transfer(const Instance *instance, const Block *block) {
    if (instance->version == 3)
        return ((Fmi3Transfer)block->call)(instance->component, block->references,
                                           (size_t)block->reference_count, block->values,
                                           (size_t)block->value_count);
    return ((Fmi2Transfer)block->call)(instance->component, block->references,
                                       (size_t)block->reference_count, block->values);
}

static int larger(int a, int b) { return a > b ? a : b; }

/* Note a call of the FMU before it is made, and its end. */
static void begin(const Instance *instance, int call) {
    if (!instance->place) return;
    instance->place->call = call;
    instance->place->turns++;
}

static void end(const Instance *instance) {
    if (instance->place) instance->place->turns++;
}

/* Set all inputs; the worst status of the calls, warnings not counted. */
static int send(Instance *instance) {
    int worst = 0;
    if (instance->version == 0) return instance->serve(SEND, 0.0, 0.0);
    begin(instance, SEND);
    for (int64_t k = 0; k < instance->set.count; k++) {
        const Block *block = &instance->set.blocks[k];
        if (block->places) stage(block, instance->set.buffer);
        worst = larger(worst, transfer(instance, block));
    }
    end(instance);
    return worst == 1 ? 0 : worst;
}

/* Scale the wired inputs where connections have gains, and set all inputs. */
int pass_on(Instance *instance, int scaled) {
    if (scaled && instance->gain)
        for (int64_t k = 0; k < instance->wired; k++)
            instance->inputs[k] = instance->inputs[k] * instance->gain[k];
    if (scaled && instance->gain)
        for (int64_t k = 0; k < instance->wired; k++)
            instance->inputs[k] = instance->inputs[k] + instance->offset[k];
    return send(instance);
}

/* Bring the inputs up to date with what the others have computed, and set them. */
int gather(Instance *instance) {
    for (int64_t k = 0; k < instance->move_count; k++) {
        const Move *move = &instance->moves[k];
        memmove(move->target, move->source, (size_t)move->count * sizeof(double));
    }
    return pass_on(instance, 1);
}

/* One doStep; a saved state is reported as kept for a rollback, if it is older than the step. */
int step_instance(Instance *instance, double time, double size) {
    int status, final = !(instance->kept < time - PRESENT * size);
    instance->steps++;
    instance->now = time + size;
    if (instance->version == 0) return instance->serve(STEP, time, size);
    if (instance->place) {
        instance->place->time = time;
        instance->place->size = size;
        instance->place->steps++;
    }
    begin(instance, STEP);
    if (instance->version == 3) {
        status = ((Fmi3Step)instance->do_step)(instance->component, time, size, final,
                                               instance->flags[0], instance->flags[1],
                                               instance->flags[2], instance->reached);
        end(instance);
        if (status <= 1 && (*instance->flags[0] || *instance->flags[1] || *instance->flags[2]))
            return REFUSED_STATUS;
    } else {
        status = ((Fmi2Step)instance->do_step)(instance->component, time, size, final);
        end(instance);
    }
    instance->warned += status == 1;
    return status == 1 ? 0 : status;
}

/* Read outputs: group 0 those that later instances need, group 1 all. */
int receive(Instance *instance, int group) {
    const Transfer *get = &instance->get[group];
    int worst = 0;
    if (instance->version == 0)
        return instance->serve(group ? RECEIVE : RECEIVE_FIRST, 0.0, 0.0);
    begin(instance, group ? RECEIVE : RECEIVE_FIRST);
    for (int64_t k = 0; k < get->count; k++) {
        const Block *block = &get->blocks[k];
        worst = larger(worst, transfer(instance, block));
        if (!block->places) continue;
        if (block->wide && !exact(block)) {
            end(instance);
            return BEYOND_STATUS;
        }
        take(block, get->buffer);
    }
    end(instance);
    if (*instance->faults && worst == 0) return 3;
    return worst == 1 ? 0 : worst;
}

int save_state(Instance *instance, void **state) {
    int status;
    if (instance->version == 0) return instance->serve(SAVE, 0.0, 0.0);
    *state = NULL;
    begin(instance, SAVE);
    status = ((StateCall)instance->get_state)(instance->component, (void *)state);
    end(instance);
    instance->saved++;
    if (instance->now < instance->kept) instance->kept = instance->now;
    return status == 1 ? 0 : status;
}

int restore_state(Instance *instance, void *state) {
    int status;
    instance->rollbacks++;
    if (instance->version == 0) return instance->serve(RESTORE, 0.0, 0.0);
    *instance->faults = 0;
    instance->now = instance->kept;
    if (instance->place) instance->place->rollbacks++;
    begin(instance, RESTORE);
    status = ((StateCall)instance->set_state)(instance->component, state);
    end(instance);
    return status == 1 ? 0 : status;
}

int forget_state(Instance *instance, void **state) {
    int status;
    if (instance->version == 0) return instance->serve(FORGET, 0.0, 0.0);
    if (--instance->saved == 0) instance->kept = INFINITY;
    begin(instance, FORGET);
    status = ((StateCall)instance->free_state)(instance->component, (void *)state);
    end(instance);
    return status == 1 ? 0 : status;
}

/* Note which call of which instance has failed. */
int failed(Run *run, const System *system, const Instance *instance, int phase, int status,
           double time, double size) {
    run->place = (int32_t)(instance - system->instances);
    run->phase = status == REFUSED_STATUS ? REFUSED : status == BEYOND_STATUS ? BEYOND : phase;
    run->status = status;
    run->time = time;
    run->size = size;
    return CALL_FAILED;
}

/* Outputs that follow inputs directly, brought up to the present communication point. */
int follow(System *system, Run *run) {
    for (int64_t k = 0; k < system->follower_count; k++) {
        Instance *instance = &system->instances[system->followers[k]];
        int status = gather(instance);
        if (status) return failed(run, system, instance, SEND, status, 0.0, 0.0);
        status = receive(instance, 1);
        if (status) return failed(run, system, instance, RECEIVE, status, 0.0, 0.0);
    }
    return 0;
}
