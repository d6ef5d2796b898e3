/* A sound library of one type; NAME and VERSION come from CMakeLists.txt. */
#include "bramah/abi.h"

static int configure(const void* self, void* memory, const bramah_value* values) {
  (void)self, (void)values;
  *(double*)memory = 0.0;
  return 0;
}
static int structure(const void* self, const void* instance, uint8_t* const mark[BRAMAH_BLOCKS]) {
  (void)self, (void)instance, (void)mark;
  return 0;
}
static int evaluate(const void* self, bramah_batch* batch) {
  (void)self, (void)batch;
  return 0;
}

static const bramah_type type = {
    .size = sizeof(bramah_type),
    .name = NAME "/thing",
    .doc = "nothing",
    .instance_bytes = sizeof(double),
    .instance_align = sizeof(double),
    .configure = configure,
    .structure = structure,
    .evaluate = evaluate,
};
static const bramah_type* const types[] = {&type};
static const bramah_library library = {
    .size = sizeof(bramah_library),
    .epoch = BRAMAH_ABI_EPOCH,
    .name = NAME,
    .version = VERSION,
    .made_with = "a test",
    .types = types,
    .type_count = 1,
};

const bramah_library* bramah_library_v1(void);
__attribute__((visibility("default"))) const bramah_library* bramah_library_v1(void) { return &library; }

#ifdef STAMP
__attribute__((used, section(".bramah_stamp"))) static const char stamp[] = STAMP;
#endif
