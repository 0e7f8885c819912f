/*
Dual numbers: a value and its derivative along one direction, carried through the same operations
as the value alone, with the rules of differentiation and no step of a difference quotient.

The values come from the functions of `semantics.h`, so that they fail where those fail. Where a
function has a kink or a jump, the derivative is that of the branch that the value is on.
*/
#ifndef DUAL_H
#define DUAL_H

#include "semantics.h"

typedef struct {
    double value, slope;
} Dual;

static inline Dual dual_of(double value, double slope)
{
    Dual made = {value, slope};
    return made;
}

static inline Dual dual_constant(double value) { return dual_of(value, 0.0); }

/* A derivative times a slope; what does not depend on the direction has none, at a pole too. */
static inline double along(double derivative, double slope)
{
    return slope == 0.0 ? 0.0 : derivative * slope;
}

/* ---- arithmetic ---- */

static inline Dual dual_negative(Dual a) { return dual_of(-a.value, -a.slope); }

static inline Dual dual_sum(Dual a, Dual b)
{
    return dual_of(a.value + b.value, a.slope + b.slope);
}

static inline Dual dual_difference(Dual a, Dual b)
{
    return dual_of(a.value - b.value, a.slope - b.slope);
}

static inline Dual dual_product(Dual a, Dual b)
{
    return dual_of(a.value * b.value, along(b.value, a.slope) + along(a.value, b.slope));
}

static inline Dual dual_ratio(Dual a, Dual b)
{
    const double ratio = a.value / b.value;
    return dual_of(ratio, (a.slope - along(ratio, b.slope)) / b.value);
}

static inline Dual dual_quotient(Fault *fault, Dual a, Dual b)
{
    quotient(fault, a.value, b.value);
    return dual_ratio(a, b);
}

static inline Dual dual_floored_of(Fault *fault, Dual a, Dual b)
{
    return dual_constant(floored_of(fault, a.value, b.value));
}

static inline Dual dual_remainder_of(Fault *fault, Dual a, Dual b)
{
    const double rest = remainder_of(fault, a.value, b.value);
    return dual_of(rest, a.slope - along(floored_of(fault, a.value, b.value), b.slope));
}

static inline Dual dual_smaller(Dual a, Dual b) { return b.value < a.value ? b : a; }

static inline Dual dual_larger(Dual a, Dual b) { return b.value > a.value ? b : a; }

static inline Dual dual_fabs(Dual a) { return copysign(1.0, a.value) < 0.0 ? dual_negative(a) : a; }

static inline Dual dual_copysign(Dual a, Dual b)
{
    return copysign(1.0, a.value) == copysign(1.0, b.value) ? a : dual_negative(a);
}

static inline Dual dual_floor_of(Fault *fault, Dual a)
{
    return dual_constant(floor_of(fault, a.value));
}

static inline Dual dual_ceil_of(Fault *fault, Dual a)
{
    return dual_constant(ceil_of(fault, a.value));
}

/* ---- math: `x` is the argument, `y` the value ---- */

#define DUAL_PLAIN(name, derivative) \
    static inline Dual dual_##name##_of(Dual a) \
    { \
        const double x = a.value, y = name##_of(x); \
        (void)x; \
        return dual_of(y, along(derivative, a.slope)); \
    }

#define DUAL_FALLIBLE(name, derivative) \
    static inline Dual dual_##name##_of(Fault *fault, Dual a) \
    { \
        const double x = a.value, y = name##_of(fault, x); \
        (void)x; \
        return dual_of(y, along(derivative, a.slope)); \
    }

DUAL_PLAIN(atan, 1.0 / (1.0 + x * x))
DUAL_PLAIN(tanh, 1.0 - y * y)
DUAL_PLAIN(asinh, 1.0 / sqrt(1.0 + x * x))
DUAL_FALLIBLE(sqrt, 0.5 / y)
DUAL_FALLIBLE(sin, cos_of(fault, x))
DUAL_FALLIBLE(cos, -sin_of(fault, x))
DUAL_FALLIBLE(tan, 1.0 + y * y)
DUAL_FALLIBLE(asin, 1.0 / sqrt(1.0 - x * x))
DUAL_FALLIBLE(acos, -1.0 / sqrt(1.0 - x * x))
DUAL_FALLIBLE(log, 1.0 / x)
DUAL_FALLIBLE(log1p, 1.0 / (1.0 + x))
DUAL_FALLIBLE(log10, 1.0 / (x * 2.302585092994046))
DUAL_FALLIBLE(log2, 1.0 / (x * 0.6931471805599453))
DUAL_FALLIBLE(sinh, cosh_of(fault, x))
DUAL_FALLIBLE(cosh, sinh_of(fault, x))
DUAL_FALLIBLE(exp, y)
DUAL_FALLIBLE(expm1, y + 1.0)

#undef DUAL_PLAIN
#undef DUAL_FALLIBLE

static inline Dual dual_atan2_of(Dual b, Dual a)
{
    const double square = a.value * a.value + b.value * b.value;
    return dual_of(atan2_of(b.value, a.value),
                   along(a.value / square, b.slope) - along(b.value / square, a.slope));
}

static inline Dual dual_pow_of(Fault *fault, Dual a, Dual b)
{
    const double y = pow_of(fault, a.value, b.value);
    return dual_of(y, along(b.value * pow(a.value, b.value - 1.0), a.slope) +
                          along(y * log(a.value), b.slope));
}

#endif
