/* A stiffening spring with a damper along a length, in C against the border alone: adds to Q of Eq. (9)
 *
 *   F = -k d - k_3 d^3 - c sdot,   d = s - s_0     N, positive where it lengthens
 *
 *   s     along   m       the length
 *   s_0           m       the length without force
 *   k, k_3        N/m, N/m^3
 *   c             N.s/m   damping
 * Rows are M a - Q, so the spring adds -F. */
#include <math.h>
#include <stddef.h>

#include "bramah/abi.h"

typedef struct spring {
  double k, k_3, c, s_0;
} spring;

static int configure(const void* self, void* memory, const bramah_value* values) {
  spring* made = memory;
  (void)self;
  made->k = values[0].numbers[0];
  made->k_3 = values[1].numbers[0];
  made->c = values[2].numbers[0];
  made->s_0 = values[3].numbers[0];
  return 0;
}

/* The force depends on s and on its rate: one entry in each of two 1 x 1 blocks. */
static int structure(const void* self, const void* instance, uint8_t* const mark[BRAMAH_BLOCKS]) {
  (void)self;
  (void)instance;
  mark[BRAMAH_F_X][0] = 1;
  mark[BRAMAH_F_V][0] = 1;
  return 0;
}

/* One number per instance in x, v, f and both blocks; a null output is not wanted. */
static int evaluate(const void* self, bramah_batch* batch) {
  const spring* springs = batch->instances;
  double* f_x = batch->partials[BRAMAH_F_X];
  double* f_v = batch->partials[BRAMAH_F_V];
  (void)self;
  for (int64_t i = 0; i < batch->count; ++i) {
    const spring* p = &springs[i];
    const double d = batch->x[i] - p->s_0;
    if (batch->f != NULL) batch->f[i] = p->k * d + p->k_3 * d * d * d + p->c * batch->v[i];
    if (f_x != NULL) f_x[i] = p->k + 3.0 * p->k_3 * d * d;
    if (f_v != NULL) f_v[i] = p->c;
  }
  return 0;
}

/* Nothing to release, no limits across parameters, no own variables, no extensions. */
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

#define PARAMETER(symbol, unit_, lower_, required_, doc_)                                                     \
  {                                                                                                           \
    .size = sizeof(bramah_parameter_info), .name = symbol, .doc = doc_, .unit = unit_, .kind = BRAMAH_NUMBER, \
    .required = required_, .count = 1, .lower = lower_, .upper = HUGE_VAL,                                    \
    .default_numbers = required_ ? NULL : &zero, .default_count = required_ ? 0 : 1                           \
  }
static const bramah_parameter_info parameters[] = {
    PARAMETER("k", "N/m", 0.0, 1, "stiffness"),
    PARAMETER("k_3", "N/m^3", -HUGE_VAL, 0, "stiffening"),
    PARAMETER("c", "N.s/m", 0.0, 0, "damping"),
    PARAMETER("s_0", "m", -HUGE_VAL, 1, "the length without force"),
};

static const bramah_port_info ports[] = {
    {.size = sizeof(bramah_port_info),
     .name = "along",
     .doc = "the length it acts on",
     .kind = "coordinate",
     .unit = "m",
     .family = BRAMAH_X,
     .slots = 1,
     .required = 1,
     .rest = NULL},
};

static const bramah_type spring_type = {
    .size = sizeof(bramah_type),
    .name = "plain_c/spring",
    .doc = "a stiffening spring with a damper along a length",
    .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .ports = ports,
    .port_count = 1,
    .nx = 1,
    .instance_bytes = sizeof(spring),
    .instance_align = _Alignof(spring),
    .configure = configure,
    .destroy = destroy,
    .check = check,
    .start = start,
    .structure = structure,
    .evaluate = evaluate,
    .extension = extension,
};

static const bramah_type* const types[] = {&spring_type};
static const bramah_library library = {
    .size = sizeof(bramah_library),
    .epoch = BRAMAH_ABI_EPOCH,
    .minor = BRAMAH_ABI_MINOR,
    .name = "plain_c",
    .version = "1.0.0",
    .made_with = "C11",
    .types = types,
    .type_count = 1,
};

/* The one exported function. */
__attribute__((visibility("default"))) const bramah_library* bramah_library_v1(void);
const bramah_library* bramah_library_v1(void) { return &library; }
