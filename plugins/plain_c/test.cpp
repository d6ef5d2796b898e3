#include <gtest/gtest.h>
#include <bramah/conformance.hpp>

extern "C" const bramah_library* bramah_library_v1(void);

TEST(Spring, Conforms) {
  const bramah_type& spring = *bramah_library_v1()->types[0];
  EXPECT_TRUE(bramah::detail::Examination(spring).run(
      {{.parameters = {{"k", 97.15}, {"k_3", 95.0}, {"c", 12.0}, {"s_0", 0.881}}}}));
}
