/* The border between the engine and its components: plain C11, one exported function per library.
 *
 * A library exports `bramah_library_v1`; it returns a static table of component types. The engine makes instances of a
 * type in memory that the engine owns, configures them, and evaluates many instances of one type in one call.
 *
 * Rules: every struct starts with its size and only grows at its end. No exception, ownership, FILE, locale or C++ type
 * crosses. Text is UTF-8, zero-terminated, and lives as long as the library (libraries are never unloaded), unless said
 * otherwise. Status: 0 ok, > 0 recoverable (the state is outside the law's domain; try a smaller step), < 0 fatal.
 * `evaluate` and the functions of extensions are pure: no state, no allocation, callable from any thread.
 * Everything is SI.
 *
 * Local variables of one instance, by family, in this order: those of its ports in the order of the ports, then its own.
 *   x  coordinates (second order: x, v = dx/dt, a = dv/dt)
 *   z  first-order variables (pressure, spool, ...: z, zdot)
 *   u  signals (value only)
 * Rows of one instance:
 *   f (nx)      forces        M a - Q                 adds to the force balance of each coordinate     Eq. (9)
 *   g (nz)      storage       K zdot - h              adds to the balance of each first-order variable Eqs. (12), (13)
 *   c (mh)      holonomic     c(t, x) = 0             the instance's own rows                          Eq. (10)
 *   r (mh+ml)   rates         [cdot; b(t, x, v)] = 0  b = B(t, x) v + b_0(t, x)                        Eqs. (11), (15)
 *   s (mh+ml)   accelerations [cddot; bdot] = 0                                                        Eq. (36)
 *   y (ny)      outputs
 * Each row has a multiplier; the engine itself adds D^T lambda (D = r_v) to f.
 */
#ifndef BRAMAH_ABI_H
#define BRAMAH_ABI_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRAMAH_ABI_EPOCH 1 /* changes break; the exported name carries it */
#define BRAMAH_ABI_MINOR 3 /* additions at the end of structs and new extensions */

enum bramah_family { BRAMAH_X = 0, BRAMAH_Z = 1, BRAMAH_U = 2 };

/* Partials: block ROWS_COLUMNS is the Jacobian of the rows with respect to the columns, all else held. */
/* clang-format off */
enum bramah_block {
  BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U,
  BRAMAH_G_X, BRAMAH_G_V, BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U,
  BRAMAH_C_X,
  BRAMAH_R_X, BRAMAH_R_V,
  BRAMAH_S_X, BRAMAH_S_V, /* s_a = r_v */
  BRAMAH_L_X,             /* d(D^T lambda)/dx, nx x nx, Eq. (23) */
  BRAMAH_Y_X, BRAMAH_Y_V, BRAMAH_Y_A, BRAMAH_Y_Z, BRAMAH_Y_U, BRAMAH_Y_LAMBDA,
  BRAMAH_BLOCKS
};
/* clang-format on */

enum bramah_parameter_kind {
  BRAMAH_NUMBER, /* one number */
  BRAMAH_VECTOR, /* a fixed count of numbers */
  BRAMAH_LIST,   /* any count of numbers */
  BRAMAH_CHOICE, /* one of `choices`, travels as its index */
  BRAMAH_TEXT
};

typedef struct bramah_parameter_info {
  size_t size;
  const char* name;
  const char* doc;
  const char* unit;               /* "Pa", "m^3/(s.Pa^0.5)", "1" */
  int32_t kind;                   /* bramah_parameter_kind */
  int32_t required;               /* 0: the default below holds */
  int64_t count;                  /* vectors: how many numbers */
  double lower, upper;            /* limits of each number; +-HUGE_VAL where there is none */
  int32_t lower_open, upper_open; /* 1: the limit itself is excluded */
  const double* default_numbers;  /* `count` numbers (1 for number and choice) */
  int64_t default_count;
  const char* default_text;
  const char* const* choices; /* null-terminated */
} bramah_parameter_info;

typedef struct bramah_port_info {
  size_t size;
  const char* name;
  const char* doc;
  const char* kind; /* "frame", "planar_frame", "coordinate", "pressure", "spool", "input", ... */
  const char* unit; /* of single-slot kinds: "Pa", "m" or "rad", ...; empty: any */
  int32_t family;   /* bramah_family */
  int32_t slots;    /* how many local variables: frame 7 (r, e), planar_frame 3 (x, y, angle), others 1 */
  int32_t required; /* 0: an unconnected port reads `rest` and its rows go nowhere */
  const double* rest;
} bramah_port_info;

typedef struct bramah_variable_info {
  size_t size;
  const char* name;
  const char* doc;
  const char* unit;
  int32_t family; /* BRAMAH_X or BRAMAH_Z */
  double nominal; /* typical magnitude, > 0: scales pivots, tolerances and ranks */
  double start;
} bramah_variable_info;

/* What others may connect to. The scene writes "component" (first terminal of the right kind) or "component.terminal". */
enum bramah_source {
  BRAMAH_OWN,      /* own variables of the family, `slots` of them from `first` on */
  BRAMAH_CONSTANT, /* the numbers of the extension bramah.constants/1 from `first` on */
  BRAMAH_SIGNAL    /* an input of the system; its value in time comes from the extension bramah.signal/1 */
};
typedef struct bramah_terminal_info {
  size_t size;
  const char* name;
  const char* doc;
  const char* kind;
  const char* unit;
  int32_t family;
  int32_t slots;
  int32_t source; /* bramah_source */
  int32_t first;
} bramah_terminal_info;

typedef struct bramah_row_info { /* constraint rows, outputs and switching functions */
  size_t size;
  const char* name;
  const char* doc;
  const char* unit;
} bramah_row_info;

typedef struct bramah_value { /* one parameter on its way to an instance */
  size_t size;
  const double* numbers;
  int64_t count;
  const char* text; /* lives until configure returns */
} bramah_value;

/* Receives one fault of an instance: which parameter (or null), what was found and what was expected. */
typedef void (*bramah_report)(void* context, const char* parameter, const char* found, const char* expected);

/* Pattern of one block, compressed by columns: rows row[start[j]] .. row[start[j+1]-1] of column j, ascending. */
typedef struct bramah_pattern {
  int64_t rows, columns, count;
  const int32_t* start; /* columns + 1 */
  const int32_t* row;   /* count */
} bramah_pattern;

/* Instances to evaluate. Numbers of one instance are contiguous and follow those of the instance before it: record i of
 * `x` starts at x + i * nx, of a block's values at partials[b] + i * patterns[b].count. A null output is not wanted. */
typedef struct bramah_batch {
  size_t size;
  int64_t count;
  const void* instances; /* instance i at instances + i * instance_bytes of the type */
  double time;
  int32_t side; /* +1 or -1: which one-sided derivative at a switching point */
  const double *x, *v, *a, *z, *zdot, *u, *lambda;
  double *f, *g, *c, *r, *s, *y;
  double* partials[BRAMAH_BLOCKS];
  const bramah_pattern* patterns; /* BRAMAH_BLOCKS patterns, those of the instances united */
  int64_t failed;                 /* set with a nonzero status: the index of the instance */
  char message[160];              /* set with a nonzero status: why */
} bramah_batch;

typedef struct bramah_type {
  size_t size;
  const char* name; /* "hydraulics/volume" */
  const char* doc;
  const bramah_parameter_info* parameters;
  const bramah_port_info* ports;
  const bramah_variable_info* variables;
  const bramah_terminal_info* terminals;
  const bramah_row_info* holonomic;
  const bramah_row_info* nonholonomic;
  const bramah_row_info* outputs;
  int32_t parameter_count, port_count, variable_count, terminal_count;
  int32_t holonomic_count, nonholonomic_count, output_count;
  int32_t nx, nz, nu; /* local variables in all */
  size_t instance_bytes, instance_align;
  const void* self; /* for the library's own use, first argument of what follows */

  /* configure, structure and evaluate are required; the others may be null and then do nothing.
   * configure makes an instance in `memory` from `values`, one per parameter in their order. */
  int (*configure)(const void* self, void* memory, const bramah_value* values);
  void (*destroy)(const void* self, void* instance);
  /* Reports what single limits cannot express; `report` may be called any number of times. */
  void (*check)(const void* self, const void* instance, bramah_report report, void* context);
  /* Start values that follow from parameters: own variables only, x, v (own coordinates) and z, preset to defaults. */
  void (*start)(const void* self, const void* instance, double* x, double* v, double* z);
  /* Marks every entry that can ever be nonzero: mark[b] is rows x columns of bytes, row-major; may be pre-marked. */
  int (*structure)(const void* self, const void* instance, uint8_t* const mark[BRAMAH_BLOCKS]);
  int (*evaluate)(const void* self, bramah_batch* batch);
  /* Optional features by id, null where not offered. */
  const void* (*extension)(const void* self, const char* id);
} bramah_type;

typedef struct bramah_library {
  size_t size;
  uint32_t epoch, minor;
  const char* name; /* "hydraulics": the first word of its types' names */
  const char* version;
  const char* made_with; /* compiler and SDK, for messages */
  const bramah_type* const* types;
  int32_t type_count;
} bramah_library;

typedef const bramah_library* (*bramah_library_function)(void);
#define BRAMAH_ENTRY_POINT "bramah_library_v1"

/* ---- extensions ------------------------------------------------------------------------------------------------ */

#define BRAMAH_EXTENSION_CONSTANTS "bramah.constants/1"
typedef struct bramah_constants {
  size_t size;
  int32_t count;
  void (*values)(const void* self, const void* instance, double* values);
} bramah_constants;

#define BRAMAH_EXTENSION_SIGNAL "bramah.signal/1"
typedef struct bramah_signal {
  size_t size;
  /* Value at t; side -1 the limit from before, +1 from after a breakpoint. */
  double (*value)(const void* self, const void* instance, double t, int32_t side);
  /* The first time after t where value or slope jumps; HUGE_VAL where there is none. */
  double (*next_breakpoint)(const void* self, const void* instance, double t);
} bramah_signal;

#define BRAMAH_EXTENSION_SWITCHES "bramah.switches/1"
/* Functions of the state whose zeros are kinks of the law: where one is zero, derivatives are one-sided. */
typedef struct bramah_switches {
  size_t size;
  int32_t count;
  const bramah_row_info* info;
  const double* nominal; /* typical magnitude of each */
  /* Reads time, x, v, z, u of the batch and writes count numbers per instance. */
  int (*values)(const void* self, const bramah_batch* batch, double* values);
} bramah_switches;

#define BRAMAH_EXTENSION_VALIDITY "bramah.validity/1"
/* Where a law holds: quantities of the state with limits, +-HUGE_VAL where there is none. A warning says where a run was
 * beyond lower or upper; beyond lowest or highest the law means nothing, no run goes on there and no analysis begins. */
typedef struct bramah_limit_info {
  size_t size;
  const char* name; /* "l_2" */
  const char* doc;  /* what the quantity is: "length of the piston-side chamber" */
  const char* unit;
  double lower, upper;
  double lowest, highest; /* lowest <= lower, highest >= upper */
  double nominal;         /* typical magnitude, > 0 */
} bramah_limit_info;
typedef struct bramah_validity {
  size_t size;
  int32_t count;
  const bramah_limit_info* info;
  /* Reads time, x, v, z, u of the batch and writes count quantities per instance. Status as in evaluate. */
  int (*values)(const void* self, const bramah_batch* batch, double* values);
} bramah_validity;

#define BRAMAH_EXTENSION_TYPICAL "bramah.typical/1"
/* What parameters are in practice: one number each, +-HUGE_VAL where there is none. Outside a warning asks for the unit. */
typedef struct bramah_typical {
  size_t size;
  const double *lower, *upper;
} bramah_typical;

#define BRAMAH_EXTENSION_FAULT "bramah.fault/1"
/* Why an entry that has no other way to say so has failed: the text of the last exception in this thread, "" where there
 * was none. Entries that give numbers then give NaN, the others a status below zero or nothing. */
typedef struct bramah_fault {
  size_t size;
  const char* (*take)(const void* self); /* and forgets it */
} bramah_fault;
/* The same of `bramah_library_v1` where it returns null: an optional function of a library. */
typedef const char* (*bramah_library_fault_function)(void);
#define BRAMAH_FAULT_POINT "bramah_library_fault_v1"

#define BRAMAH_EXTENSION_TANGENT "bramah.tangent/1"
/* Which way the inputs of a batch move with eps: records as in bramah_batch, null for those that stay. */
typedef struct bramah_direction {
  size_t size;
  const double *x, *v, *a, *z, *zdot, *u, *lambda;
} bramah_direction;

/* Exact derivatives by eps, where inputs move along a direction and the parameters of an instance along another:
 *   d/deps row(y + eps dy, p + eps dp),  d/deps partial(y + eps dy, p + eps dp)   at eps = 0
 * Parameters move in instances that the `configure` below has made; instances of bramah_type.configure stand still. */
typedef struct bramah_tangent {
  size_t size;
  const uint8_t* differentiable; /* one byte per parameter, 1: dp may be nonzero */
  /* As bramah_type.configure, for an instance whose parameters move: `tangents` has dp, laid out like `values`, null
   * numbers for a parameter that stays. The instance serves every other function as well, and is destroyed alike. */
  int (*configure)(const void* self, void* memory, const bramah_value* values, const bramah_value* tangents);
  /* As bramah_type.evaluate, with derivatives by eps in place of all rows and partials; same patterns, same status. */
  int (*evaluate)(const void* self, bramah_batch* batch, const bramah_direction* direction);
  /* Derivatives of what `start`, bramah_constants and bramah_signal give; null where the type has none of these. x, v and
   * z are preset to zero. */
  void (*start)(const void* self, const void* instance, double* x, double* v, double* z);
  void (*constants)(const void* self, const void* instance, double* values);
  double (*signal)(const void* self, const void* instance, double t, int32_t side);
} bramah_tangent;

#define BRAMAH_EXTENSION_ENERGY "bramah.energy/1"
/* What instances store, J: a function of x, v, z and constant u alone. From it and the rows follows the power that a
 * component brings into the machine. */
typedef struct bramah_energy {
  size_t size;
  /* Writes one number per instance: the energy, and its derivative by eps where x, v, z move along `direction`. Reads x, v,
   * z, u of the batch. Status as in evaluate. */
  int (*values)(const void* self, const bramah_batch* batch, const bramah_direction* direction, double* energy,
                double* rate);
} bramah_energy;

#ifdef __cplusplus
}
#endif
#endif
