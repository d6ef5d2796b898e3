#include "io/matrix_files.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace bramah::testing {
namespace {

constexpr double matrix[] = {1.0,      3.0, 0.1, -4e-300, std::numeric_limits<double>::max(),
                             1.0 / 3.0};  // 2 x 3, by columns

TEST(Csv, CarriesNamesAndAllDigits) {
  EXPECT_EQ(csv_of({matrix, 2, 3}, {"a", "b"}, {"x", "y", "z"}),
            ",x,y,z\n"
            "a,1,0.10000000000000001,1.7976931348623157e+308\n"
            "b,3,-4.0000000000000001e-300,0.33333333333333331\n");
}

TEST(MatrixMarket, CountsFromOneWithAllDigits) {
  EXPECT_EQ(matrix_market(3, 2, {{0, 1, 0.1}, {2, 0, -1.0 / 3.0}}),
            "%%MatrixMarket matrix coordinate real general\n"
            "3 2 2\n"
            "1 2 0.10000000000000001\n"
            "3 1 -0.33333333333333331\n");
}

template <class T>
T at(const std::string& bytes, std::size_t position) {
  T value;
  std::memcpy(&value, bytes.data() + position, sizeof value);
  return value;
}

TEST(MatFile, IsLevel5AsDocumented) {
  const std::string file = mat_file({{"A", {matrix, 2, 3}, {}}, {"states", {}, {"phi", "p"}}});
  ASSERT_EQ(file.size() % 8, 0U);
  EXPECT_EQ(file.substr(0, 19), "MATLAB 5.0 MAT-file");
  EXPECT_EQ(at<std::uint16_t>(file, 124), 0x0100);
  EXPECT_EQ(file.substr(126, 2), "IM");
  // First variable: matrix, flags (double), dimensions 2 x 3, name, six doubles.
  EXPECT_EQ(at<std::uint32_t>(file, 128), 14U);
  EXPECT_EQ(at<std::uint32_t>(file, 144), 6U);
  EXPECT_EQ(at<std::int32_t>(file, 160), 2);
  EXPECT_EQ(at<std::int32_t>(file, 164), 3);
  EXPECT_EQ(file[176], 'A');
  EXPECT_EQ(at<std::uint32_t>(file, 184), 9U);
  EXPECT_EQ(at<std::uint32_t>(file, 188), sizeof matrix);
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): bytes are what the file is about
  EXPECT_EQ(std::memcmp(file.data() + 192, matrix, sizeof matrix), 0);
  // Second variable begins where the first says it ends; text of 2 rows and 3 columns, column by column.
  const std::size_t second = 136 + at<std::uint32_t>(file, 132);
  EXPECT_EQ(second, 240U);
  EXPECT_EQ(at<std::uint32_t>(file, second + 16), 4U);
  EXPECT_EQ(at<std::int32_t>(file, second + 32), 2);
  EXPECT_EQ(at<std::int32_t>(file, second + 36), 3);
  const std::size_t letters = second + 64;
  EXPECT_EQ(at<std::uint32_t>(file, second + 56), 4U);
  const char16_t expected[] = {u'p', u'p', u'h', u' ', u'i', u' '};
  EXPECT_EQ(std::memcmp(file.data() + letters, expected, sizeof expected), 0);
}

}  // namespace
}  // namespace bramah::testing
