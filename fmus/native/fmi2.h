/*
The FMI 2.0 interface for co-simulation, as far as a part offers it: types and functions by the
names and orders of the standard, written for this project.

Functions are exported under their own names. A program that links several parts statically gives
each a prefix of its own: -DFMI2_FUNCTION_PREFIX=amplifier_
*/
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#define fmi2TypesPlatform "default"
#define fmi2Version "2.0"

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOINED(prefix, name) prefix##name
#define FMI2_NAMED(prefix, name) FMI2_JOINED(prefix, name)
#define FMI2(name) FMI2_NAMED(FMI2_FUNCTION_PREFIX, name)
#define FMI2_EXPORT
#elif defined(_WIN32)
#define FMI2(name) name
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2(name) name
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2(name) name
#define FMI2_EXPORT
#endif

#endif
