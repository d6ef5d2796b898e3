/* The border is C11: sizes and offsets as this language sees them, for abi_test.cpp to compare. */
#include "bramah/abi.h"

#include "plugin/abi_layout.h"

const layout_entry layout_in_c[] = {LAYOUT};
const size_t layout_in_c_count = sizeof layout_in_c / sizeof layout_in_c[0];
