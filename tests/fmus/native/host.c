/*
A host without Python: host LIBRARY GUID INPUTS PARAMETERS OUTPUTS STEPS SIZE

Reads one row of inputs a step from standard input, and writes one row of outputs before the
first step and after each. In the middle it goes back three steps by an FMU state and repeats them
with the inputs it has kept, so what it writes there comes out of the second pass. It ends with
status 3 if anything of Python is in the process.
*/
#define _GNU_SOURCE
#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
#else
#include <dlfcn.h>
#endif
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#define BACK 3

static void *library;

#ifdef _WIN32
static void *opened(const char *path)
{
    _setmode(_fileno(stdin), _O_BINARY);
    _setmode(_fileno(stdout), _O_BINARY);
    void *found = LoadLibraryA(path);
    if (!found)
        fprintf(stderr, "%s: error %lu\n", path, GetLastError());
    return found;
}

static void *symbol(const char *name)
{
    return (void *)GetProcAddress(library, name);
}
#else
static void *opened(const char *path)
{
    void *found = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!found)
        fprintf(stderr, "%s\n", dlerror());
    return found;
}

static void *symbol(const char *name)
{
    return dlsym(library, name);
}
#endif

static void *function(const char *name)
{
    void *found = symbol(name);
    if (!found) {
        fprintf(stderr, "no %s\n", name);
        exit(2);
    }
    return found;
}

static void check(fmi2Status status, const char *call)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", call, status);
        exit(1);
    }
}

static void heard(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                  fmi2String category, fmi2String message, ...)
{
    (void)environment;
    va_list rest;
    va_start(rest, message);
    fprintf(stderr, "%s [%d] %s: ", name, status, category);
    vfprintf(stderr, message, rest);
    fputc('\n', stderr);
    va_end(rest);
}

static int has_python(void)
{
    char line[4096];
    int found = 0;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && fgets(line, sizeof line, maps)) {
        char *path = strchr(line, '/');
        char *name = path ? strrchr(path, '/') : NULL;
        found |= name && strstr(name, "python") != NULL;
    }
    if (maps)
        fclose(maps);
    return found;
}

int main(int count, char **given)
{
    if (count != 8)
        return 2;
    size_t inputs = strtoul(given[3], NULL, 10), parameters = strtoul(given[4], NULL, 10);
    size_t outputs = strtoul(given[5], NULL, 10), steps = strtoul(given[6], NULL, 10);
    double size = strtod(given[7], NULL);
    library = opened(given[1]);
    if (!library)
        return 2;
    fmi2InstantiateTYPE *instantiate = function("fmi2Instantiate");
    fmi2SetupExperimentTYPE *setup = function("fmi2SetupExperiment");
    fmi2EnterInitializationModeTYPE *enter = function("fmi2EnterInitializationMode");
    fmi2ExitInitializationModeTYPE *leave = function("fmi2ExitInitializationMode");
    fmi2SetRealTYPE *set = function("fmi2SetReal");
    fmi2GetRealTYPE *get = function("fmi2GetReal");
    fmi2DoStepTYPE *advance = function("fmi2DoStep");
    fmi2GetFMUstateTYPE *save = function("fmi2GetFMUstate");
    fmi2SetFMUstateTYPE *restore = function("fmi2SetFMUstate");
    fmi2FreeFMUstateTYPE *forget = function("fmi2FreeFMUstate");

    fmi2CallbackFunctions callbacks = {heard, calloc, free, NULL, NULL};
    fmi2Component unit = instantiate("unit", fmi2CoSimulation, given[2], "", &callbacks, 0, 1);
    if (!unit)
        return 1;
    fmi2ValueReference *in = calloc(inputs, sizeof *in), *out = calloc(outputs, sizeof *out);
    for (size_t k = 0; k < inputs; k++)
        in[k] = (fmi2ValueReference)k;
    for (size_t k = 0; k < outputs; k++)
        out[k] = (fmi2ValueReference)(inputs + parameters + k);
    double *rows = calloc(steps * inputs, sizeof *rows), *row = calloc(outputs, sizeof *row);
    if (fread(rows, sizeof *rows, steps * inputs, stdin) != steps * inputs)
        return 2;

    check(setup(unit, 0, 0.0, 0.0, 0, 0.0), "setup");
    check(enter(unit), "enter");
    check(leave(unit), "exit");
    check(get(unit, out, outputs, row), "get");
    fwrite(row, sizeof *row, outputs, stdout);
    fmi2FMUstate state = NULL;
    size_t gone_back = 0, middle = steps / 2;
    for (size_t k = 0; k < steps; k++) {
        if (k == middle && !gone_back)
            check(save(unit, &state), "save");
        check(set(unit, in, inputs, rows + k * inputs), "set");
        check(advance(unit, (double)k * size, size, 0), "step");
        check(get(unit, out, outputs, row), "get");
        int first_pass = !gone_back && k >= middle && k < middle + BACK;
        if (!first_pass)
            fwrite(row, sizeof *row, outputs, stdout);
        if (first_pass && k == middle + BACK - 1) {
            check(restore(unit, state), "restore");
            check(forget(unit, &state), "forget");
            gone_back = 1;
            k = middle - 1;
        }
    }
    check(((fmi2TerminateTYPE *)function("fmi2Terminate"))(unit), "terminate");
    ((fmi2FreeInstanceTYPE *)function("fmi2FreeInstance"))(unit);
    return has_python() ? 3 : 0;
}
