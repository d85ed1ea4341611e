#include "core/formats/safetensors.h"

#include <gtest/gtest.h>

namespace mocurate {
namespace {

Safetensors TwoTensors() {
  Safetensors file;
  file.metadata = {{"format", "pt"}};
  file.tensors = {{"b.weight", {2, 3}, {1, 2, 3, 4, 5, 6}}, {"a", {}, {7}}, {"empty", {0, 4}, {}}};
  return file;
}

TEST(Safetensors, RoundTripThroughTheWriter) {
  const std::string bytes = EncodeSafetensors(TwoTensors());
  const auto file = ParseSafetensors(bytes, "x");
  ASSERT_TRUE(file) << file.error().Message();
  EXPECT_EQ(file->metadata.at("format"), "pt");
  ASSERT_EQ(file->tensors.size(), 3u);
  EXPECT_EQ(file->tensors[0].name, "b.weight");
  EXPECT_EQ(file->tensors[0].shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(file->tensors[0].values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(EncodeSafetensors(*file), bytes);
}

/// A file of another writer, from header and numbers.
std::string Made(const std::string& header, std::size_t numbers) {
  std::string bytes(8, '\0');
  bytes[0] = static_cast<char>(header.size());
  return bytes + header + std::string(4 * numbers, 'x');
}

TEST(Safetensors, AreRejectedWhenTheirSizesDisagree) {
  EXPECT_TRUE(ParseSafetensors(Made(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 2), "x"));
  for (const std::string& bytes :
       {std::string("short"), Made("{", 0), Made("[]", 0), Made(R"({"a":{"dtype":"F32"}})", 0),
        Made(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 1),
        Made(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 3),
        Made(R"({"a":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})", 2),
        Made(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})", 2),
        Made(R"({"a":{"dtype":"F32","shape":[4611686018427387905,4],"data_offsets":[0,4]}})", 1),
        Made(R"({"__metadata__":{"a":1}})", 0)}) {
    const auto file = ParseSafetensors(bytes, "x");
    ASSERT_FALSE(file) << bytes;
    EXPECT_EQ(file.error().code, ErrorCode::kMalformed) << bytes;
  }
  const auto half = ParseSafetensors(Made(R"({"a":{"dtype":"F16","shape":[2],"data_offsets":[0,4]}})", 1), "x");
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mocurate
