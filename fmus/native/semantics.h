/*
What Python does where C does otherwise: errors, divisions, look-ups in tables, minima, whole
numbers. Translated physics calls these in the place of the bare operators of C.

An error leaves through `fail`, back to where `setjmp` was called on the `Fault`. Functions of the
C library that can round are called through a volatile pointer, so that no compiler works them out
itself, with other last digits than the library's.
*/
#ifndef SEMANTICS_H
#define SEMANTICS_H

#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "words.h"

#ifdef __FAST_MATH__
#error "this code needs the rules of IEEE 754: build it without -ffast-math"
#endif

/* no fused multiply-add, whatever the flags are */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize "fp-contract=off"
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#else
#pragma STDC FP_CONTRACT OFF
#endif

#if defined(__GNUC__)
#define NO_RETURN __attribute__((noreturn, cold))
#define INTERNAL __attribute__((visibility("hidden")))
#define RARE __attribute__((noinline, cold))
#elif defined(_MSC_VER)
#define NO_RETURN __declspec(noreturn)
#define INTERNAL
#define RARE
#else
#define NO_RETURN
#define INTERNAL
#define RARE
#endif

#ifdef __APPLE__
#define MARK(fault) _setjmp((fault)->back)
#define RETURN(fault) _longjmp((fault)->back, 1)
#else
#define MARK(fault) setjmp((fault)->back)
#define RETURN(fault) longjmp((fault)->back, 1)
#endif

/* Where a failure leads, and what caused it. */
typedef struct {
    const char *cause;
    jmp_buf back;
} Fault;

static inline NO_RETURN void fail(Fault *fault, const char *cause)
{
    fault->cause = cause;
    RETURN(fault);
}

/* ---- tables ---- */

/* A row of a table, and a table of rows, of any length. */
typedef struct {
    const double *at;
    int64_t count;
} Row;

typedef struct {
    const double *at;
    int64_t rows, count;
} Table;

/* An index within a length; negative ones count from the end. */
static inline int64_t within(Fault *fault, int64_t index, int64_t count)
{
    if ((uint64_t)index < (uint64_t)count)
        return index;
    if (index >= 0 || index < -count)
        fail(fault, OUT_OF_RANGE);
    return index + count;
}

static inline Row row_of(Fault *fault, Table table, int64_t index)
{
    Row row = {table.at + within(fault, index, table.rows) * table.count, table.count};
    return row;
}

static inline double entry_of(Fault *fault, Row row, int64_t index)
{
    return row.at[within(fault, index, row.count)];
}

/* ---- arithmetic ---- */

static inline double quotient(Fault *fault, double a, double b)
{
    if (b == 0.0)
        fail(fault, ZERO_DIVISION);
    return a / b;
}

/* Remainder with the sign of the divisor, and the whole number that goes with it. */
static inline double remainder_of(Fault *fault, double a, double b)
{
    double rest;
    if (b == 0.0)
        fail(fault, ZERO_MODULO);
    rest = fmod(a, b);
    if (rest == 0.0)
        return copysign(0.0, b);
    return (b < 0.0) != (rest < 0.0) ? rest + b : rest;
}

static inline double floored_of(Fault *fault, double a, double b)
{
    double rest, whole, down;
    if (b == 0.0)
        fail(fault, ZERO_FLOOR);
    rest = fmod(a, b);
    whole = (a - rest) / b;
    if (rest != 0.0 && (b < 0.0) != (rest < 0.0))
        whole -= 1.0;
    if (whole == 0.0)
        return copysign(0.0, a / b);
    down = floor(whole);
    return whole - down > 0.5 ? down + 1.0 : down;
}

static inline int64_t whole_remainder(Fault *fault, int64_t a, int64_t b)
{
    int64_t rest;
    if (b == 0)
        fail(fault, ZERO_WHOLE_MODULO);
    rest = a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

static inline int64_t whole_floored(Fault *fault, int64_t a, int64_t b)
{
    int64_t ratio;
    if (b == 0)
        fail(fault, ZERO_WHOLE_FLOOR);
    ratio = a / b;
    return a % b != 0 && (a < 0) != (b < 0) ? ratio - 1 : ratio;
}

/* The first of two that are equal or no numbers. */
static inline double smaller(double a, double b) { return b < a ? b : a; }

static inline double larger(double a, double b) { return b > a ? b : a; }

static inline int64_t whole_smaller(int64_t a, int64_t b) { return b < a ? b : a; }

static inline int64_t whole_larger(int64_t a, int64_t b) { return b > a ? b : a; }

/* int(): towards zero. Python goes on beyond 64 bits; here the largest are 2^62, so that a count
   may still be added. */
#define MOST_WHOLE 4611686018427387904.0

static inline void finite_of(Fault *fault, double x)
{
    if (isinf(x))
        fail(fault, INFINITE_TO_WHOLE);
    if (isnan(x))
        fail(fault, NAN_TO_WHOLE);
}

static inline int64_t whole_of(Fault *fault, double x)
{
    if (x > -MOST_WHOLE && x < MOST_WHOLE)
        return (int64_t)x;
    finite_of(fault, x);
    return x < 0.0 ? -(int64_t)MOST_WHOLE : (int64_t)MOST_WHOLE;
}

/* ---- math ---- */

#define PI 3.141592653589793

#define PLAIN(name) \
    static inline double name##_of(double x) \
    { \
        static double (*volatile const library)(double) = name; \
        return library(x); \
    }

/* NaN from a number, and infinity from a finite one: a pole. */
#define BOUNDED(name) \
    static inline double name##_of(Fault *fault, double x) \
    { \
        static double (*volatile const library)(double) = name; \
        double y = library(x); \
        if (!isfinite(y) && !isnan(x) && (isnan(y) || isfinite(x))) \
            fail(fault, DOMAIN_ERROR); \
        return y; \
    }

/* Infinity from a finite number: too large. */
#define GROWING(name) \
    static inline double name##_of(Fault *fault, double x) \
    { \
        static double (*volatile const library)(double) = name; \
        double y = library(x); \
        if (isinf(y) && isfinite(x)) \
            fail(fault, RANGE_ERROR); \
        return y; \
    }

PLAIN(atan)
PLAIN(tanh)
PLAIN(asinh)
BOUNDED(sin)
BOUNDED(cos)
BOUNDED(tan)
BOUNDED(asin)
BOUNDED(acos)
BOUNDED(log)
BOUNDED(log1p)
BOUNDED(log10)
BOUNDED(log2)
GROWING(sinh)
GROWING(cosh)
GROWING(exp)
GROWING(expm1)

static inline double atan2_of(double y, double x)
{
    static double (*volatile const library)(double, double) = atan2;
    return library(y, x);
}

/* A root is exact everywhere, so that the compiler may have it. */
static inline double sqrt_of(Fault *fault, double x)
{
    if (x < 0.0)
        fail(fault, DOMAIN_ERROR);
    return sqrt(x);
}

static inline double pow_of(Fault *fault, double x, double y)
{
    static double (*volatile const library)(double, double) = pow;
    double z = library(x, y);
    if (isfinite(x) && isfinite(y)) {
        if (isnan(z))
            fail(fault, DOMAIN_ERROR);
        if (isinf(z))
            fail(fault, x == 0.0 ? DOMAIN_ERROR : RANGE_ERROR);
    }
    return z;
}

/* floor() and ceil() give an int in Python, which is never -0. */
static inline double floor_of(Fault *fault, double x)
{
    finite_of(fault, x);
    return floor(x) + 0.0;
}

static inline double ceil_of(Fault *fault, double x)
{
    finite_of(fault, x);
    return ceil(x) + 0.0;
}

#undef PLAIN
#undef BOUNDED
#undef GROWING

#endif
