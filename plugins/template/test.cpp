#include <gtest/gtest.h>
#include <bramah/conformance.hpp>

#include "strut.cpp"

TEST(SpringDamper, Conforms) {
  EXPECT_TRUE(bramah::conforms<SpringDamper>({{.parameters = {{"k", 100.0}, {"c", 12.0}, {"s_0", 0.9}}}}));
}
