// The spring of probe.cpp in C, right with M = 0. Every other M is one mistake of those who fill tables by hand.
#include <math.h>
#include <stddef.h>
#include "bramah/abi.h"
#ifndef M
#define M 0
#endif
#ifndef LIBRARY
#define LIBRARY "by_hand"
#endif
typedef struct {
  double k, c;
} spring;

static int configure(const void* self, void* memory, const bramah_value* values) {
  spring* made = memory;
  (void)self;
  made->k = values[0].numbers[0];
  made->c = values[1].numbers[0];
  return 0;
}
static int structure(const void* self, const void* instance, uint8_t* const mark[BRAMAH_BLOCKS]) {
  (void)self;
  (void)instance;
  mark[BRAMAH_F_X][0] = 1;
#if M != 1
  mark[BRAMAH_F_V][0] = 1;
#endif
  return 0;
}
static int evaluate(const void* self, bramah_batch* batch) {
  const spring* springs = batch->instances;
  double *f_x = batch->partials[BRAMAH_F_X], *f_v = batch->partials[BRAMAH_F_V];
  (void)self;
#if M == 8
  return 1;
#endif
  for (int64_t i = 0; i < batch->count; ++i) {
    const spring* p = &springs[i];
    if (batch->f != NULL) batch->f[i] = p->k * batch->x[i] + p->c * batch->v[i];
#if M == 4
    if (batch->f != NULL) batch->f[i + 100000] = 1e9;
#endif
    if (f_x != NULL) f_x[i] = (M == 2 ? 2.0 : 1.0) * p->k;
    if (f_v != NULL && M != 3) f_v[i] = p->c;
  }
  return 0;
}
static void destroy(const void* self, void* instance) {
  (void)self;
  (void)instance;
}
static void check(const void* self, const void* instance, bramah_report report, void* context) {
  (void)self;
  (void)instance;
  (void)report;
  (void)context;
}
static void start(const void* self, const void* instance, double* x, double* v, double* z) {
  (void)self;
  (void)instance;
  (void)x;
  (void)v;
  (void)z;
}
static const void* extension(const void* self, const char* id) {
  (void)self;
  (void)id;
  return NULL;
}
static const double zero = 0.0;
static const bramah_parameter_info parameters[] = {{.size = sizeof(bramah_parameter_info),
                                                    .name = "k",
                                                    .doc = "stiffness",
                                                    .unit = "N/m",
                                                    .kind = BRAMAH_NUMBER,
                                                    .required = 1,
                                                    .count = 1,
                                                    .lower = 0.0,
                                                    .upper = HUGE_VAL},
                                                   {.size = sizeof(bramah_parameter_info),
                                                    .name = "c",
                                                    .doc = "damping",
                                                    .unit = "N.s/m",
                                                    .kind = BRAMAH_NUMBER,
                                                    .count = 1,
                                                    .lower = 0.0,
                                                    .upper = HUGE_VAL,
                                                    .default_numbers = &zero,
                                                    .default_count = 1}};
static const bramah_port_info ports[] = {{.size = sizeof(bramah_port_info),
                                          .name = "along",
                                          .doc = "the length it acts on",
                                          .kind = "coordinate",
                                          .unit = "m",
                                          .family = BRAMAH_X,
                                          .slots = 1,
                                          .required = 1}};
static const bramah_type spring_type = {.size = sizeof(bramah_type),
                                        .name = LIBRARY "/spring",
                                        .doc = "a spring",
                                        .parameters = parameters,
                                        .parameter_count = M == 6 ? 4000 : 2,
                                        .ports = ports,
                                        .port_count = 1,
                                        .nx = 1,
                                        .instance_bytes = M == 7 ? 8 : sizeof(spring),
                                        .instance_align = _Alignof(spring),
                                        .configure = configure,
                                        .destroy = destroy,
                                        .check = check,
                                        .start = start,
                                        .structure = structure,
                                        .evaluate = evaluate,
                                        .extension = extension};
static const bramah_type* const types[] = {&spring_type};
static const bramah_library library = {.size = sizeof(bramah_library),
                                       .epoch = BRAMAH_ABI_EPOCH,
                                       .minor = BRAMAH_ABI_MINOR,
                                       .name = LIBRARY,
                                       .version = "1.0.0",
                                       .made_with = "C11",
                                       .types = types,
                                       .type_count = M == 5 ? 9 : 1};
__attribute__((visibility("default"))) const bramah_library* bramah_library_v1(void);
const bramah_library* bramah_library_v1(void) { return &library; }
