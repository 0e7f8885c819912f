/*
The monolith's right-hand side, as `reference.py` calls it: one block of doubles in, one out.

The records are nothing but doubles, one after the other, so a block of doubles is read as one.
*/
#include <string.h>

#include "part.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    Composition composition;
    Input drive;
    double inside;
} Constants;

/* Where the derivative cannot be worked out, the cause; else NULL. */
EXPORT const char *reference_rates(const double *constants, double t, const double *y,
                                   double *after)
{
    Fault fault;
    Constants c;
    Vector state, rates;
    memcpy(&c, constants, sizeof c);
    memcpy(&state, y, sizeof state);
    if (MARK(&fault))
        return fault.cause;
    rates = equations_rates(&fault, &c.composition, &c.drive, c.inside, t, &state);
    memcpy(after, &rates, sizeof rates);
    return NULL;
}
