/* Libraries that must not load, one fault each: CMakeLists.txt compiles this file once for every FAULTY_... below. Without
 * one of them it is a sound library of one type without ports and parameters. */
#include <stddef.h>

#include "bramah/abi.h"

#ifndef LIBRARY
#define LIBRARY "faulty"
#endif
#ifndef TYPE
#define TYPE LIBRARY "/thing"
#endif
#ifndef ENTRY
#define ENTRY bramah_library_v1
#endif
#ifndef EPOCH
#define EPOCH BRAMAH_ABI_EPOCH
#endif
#ifndef SECOND_VARIABLE
#define SECOND_VARIABLE "q"
#endif

static int configure(const void* self, void* memory, const bramah_value* values) {
  (void)self, (void)values;
  *(double*)memory = 0.0;
  return 0;
}
static int structure(const void* self, const void* instance, uint8_t* const mark[BRAMAH_BLOCKS]) {
  (void)self, (void)instance, (void)mark;
  return 0;
}
#ifndef FAULTY_EVALUATE
static int evaluate(const void* self, bramah_batch* batch) {
  (void)self, (void)batch;
  return 0;
}
#endif

static const bramah_variable_info variables[] = {
    {sizeof(bramah_variable_info), "p", "", "Pa", BRAMAH_Z, 1.0, 0.0},
    {sizeof(bramah_variable_info), SECOND_VARIABLE, "", "Pa", BRAMAH_Z, 1.0, 0.0},
};
static const bramah_type type = {
    .size = sizeof(bramah_type),
    .name = TYPE,
    .doc = "nothing",
    .variables = variables,
    .variable_count = 2,
    .nz = 2,
    .instance_bytes = sizeof(double),
    .instance_align = sizeof(double),
    .configure = configure,
    .structure = structure,
#ifndef FAULTY_EVALUATE
    .evaluate = evaluate,
#endif
};
#ifdef FAULTY_TYPES
static const bramah_type* const types[] = {&type, &type};
#else
static const bramah_type* const types[] = {&type};
#endif

static const bramah_library library = {
#ifdef FAULTY_SIZE
    .size = sizeof(size_t),
#else
    .size = sizeof(bramah_library),
#endif
    .epoch = EPOCH,
    .name = LIBRARY,
    .version = "1.0.0",
    .made_with = "a test",
    .types = types,
    .type_count = sizeof types / sizeof types[0],
};

const bramah_library* ENTRY(void);
__attribute__((visibility("default"))) const bramah_library* ENTRY(void) {
#ifdef FAULTY_TABLE
  (void)library;
  return NULL;
#else
  return &library;
#endif
}
