// results.npy of MDM: files of numpy, dictionaries without optional keys, and invalid dictionaries.

#include "core/formats/mdm_results.h"

#include <gtest/gtest.h>

#include "core/formats/pickle_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/pickle_samples.h"

namespace mocurate {
namespace {

TEST(MdmResults, AreReadFramesFirstAndCutToTheirLengths) {
  const std::string bytes = FromHex(kMdmResults);
  const auto results = MdmResults::Open(bytes, "results.npy");
  ASSERT_TRUE(results) << results.error().Message();
  ASSERT_EQ(results->size(), 2u);
  EXPECT_EQ(results->joints(), 3u);
  EXPECT_EQ(results->Label(0), "walk");
  EXPECT_EQ(results->Label(1), "sit down");
  const std::size_t frames[] = {4, 2};
  for (std::size_t m = 0; m < 2; ++m) {
    const auto motion = results->Motion(m);
    ASSERT_TRUE(motion) << motion.error().Message();
    ASSERT_EQ(motion->shape, (std::vector<std::size_t>{frames[m], 3, 3}));
    for (std::size_t f = 0; f < frames[m]; ++f) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_EQ(motion->values[(f * 3 + j) * 3 + k], static_cast<double>(((m * 3 + j) * 3 + k) * 4 + f));
        }
      }
    }
  }
}

/// A dictionary as MDM writes it, without numpy's enclosing one-object array.
struct MdmDictionary {
  std::vector<std::size_t> shape = {2, 3, 3, 4};
  std::vector<double> lengths = {4, 2};
  std::vector<std::string> texts = {"walk", "sit"};
  std::string excluded;

  std::string Npy() const {
    PickleWriter writer;
    writer.BeginDict();
    NpyArray motion;
    motion.dtype = "<f4";
    motion.shape = shape;
    std::size_t count = 1;
    for (const std::size_t extent : shape) count *= extent;
    motion.values.assign(count, 0.5);
    if (excluded != "motion") {
      writer.Text("motion");
      writer.Array(motion);
    }
    if (excluded != "lengths") {
      NpyArray array;
      array.dtype = "<i8";
      array.shape = {lengths.size()};
      array.values = lengths;
      writer.Text("lengths");
      writer.Array(array);
    }
    if (excluded != "text") {
      writer.Text("text");
      writer.BeginList();
      for (const std::string& text : texts) writer.Text(text);
      writer.End();
    }
    writer.End();
    std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
    header += std::string(117 - header.size(), ' ') + "\n";
    return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + writer.Finish("results.npy").value();
  }
};

TEST(MdmResults, LengthsAndTextsMayBeAbsent) {
  for (const char* key : {"lengths", "text"}) {
    MdmDictionary written;
    written.excluded = key;
    const std::string bytes = written.Npy();
    const auto results = MdmResults::Open(bytes, "results.npy");
    ASSERT_TRUE(results) << key << ": " << results.error().Message();
    EXPECT_EQ(results->Label(1), key == std::string("text") ? "" : "sit");
    EXPECT_EQ(results->Motion(1)->shape[0], key == std::string("lengths") ? 4u : 2u);
  }
}

TEST(MdmResults, AreRejectedWithTheKeyThatDoesNotFit) {
  MdmDictionary no_motion, flat, long_one, zero_length, uneven, few;
  no_motion.excluded = "motion";
  flat.shape = {2, 9, 4};
  long_one.lengths = {4, 5};
  zero_length.lengths = {4, 0};
  uneven.lengths = {4};
  few.texts = {"walk"};
  const std::pair<MdmDictionary, const char*> cases[] = {
      {no_motion, "results.npy:/"},         {flat, "results.npy:/motion"},    {long_one, "results.npy:lengths"},
      {zero_length, "results.npy:lengths"}, {uneven, "results.npy:/lengths"}, {few, "results.npy:/text"}};
  for (const auto& [written, where] : cases) {
    const std::string bytes = written.Npy();
    ExpectMalformed(MdmResults::Open(bytes, "results.npy"), where);
  }
}

}  // namespace
}  // namespace mocurate
