#include "core/formats/torch_pickle.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/zip_archive.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

std::string PickleBytes(const std::string& body) { return std::string("\x80\x02", 2) + body + "."; }

std::string PickledText(const std::string& text) {
  return std::string("X") + static_cast<char>(text.size()) + std::string(3, '\0') + text;
}

const std::string kMagic("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 15);

// A torch.save file around the pickle of its object, without storages.
std::string TorchFile(const std::string& object, const std::string& keys = "]", const std::string& storages = "") {
  return kMagic + PickleBytes(std::string("M\xe9\x03", 3)) + PickleBytes("}" + PickledText("little_endian") + "\x88s") +
         PickleBytes(object) + PickleBytes(keys) + storages;
}

std::string Storage(const std::string& element_class, int size) {
  return "((" + PickledText("storage") + "ctorch\n" + element_class + "\n" + PickledText("7") + PickledText("cpu") +
         "K" + static_cast<char>(size) + "NtQ";
}

// {"w": tensor} with a storage of `stored` floats.
std::string TensorObject(int stored, int offset, int rows, int columns, int row_stride, int column_stride) {
  const auto k = [](int value) { return std::string("K") + static_cast<char>(value); };
  return "}" + PickledText("w") + "ctorch._utils\n_rebuild_tensor_v2\n" + Storage("FloatStorage", stored) + k(offset) +
         k(rows) + k(columns) + "\x86" + k(row_stride) + k(column_stride) + "\x86\x89NtRs";
}

std::string Floats(const std::vector<float>& values) {
  const std::int64_t count = static_cast<std::int64_t>(values.size());
  return std::string(reinterpret_cast<const char*>(&count), 8) +
         std::string(reinterpret_cast<const char*>(values.data()), 4 * values.size());
}

TEST(TorchPickle, ReadsATensorThroughItsStrides) {
  const std::string bytes =
      TorchFile(TensorObject(6, 0, 2, 3, 1, 2), "](" + PickledText("7") + "e", Floats({0, 1, 2, 3, 4, 5}));
  const Expected<TorchTable> table = ParseTorchPickle(bytes, "t.tar");
  ASSERT_TRUE(table) << table.error().Message();
  const TorchTensor* tensor = table->Find("w");
  ASSERT_NE(tensor, nullptr);
  EXPECT_EQ(tensor->shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(tensor->values, (std::vector<double>{0, 2, 4, 1, 3, 5}));
}

TEST(TorchPickle, RejectsATensorBeyondItsStorage) {
  for (const auto& object : {TensorObject(6, 1, 2, 3, 1, 2), TensorObject(6, 0, 2, 4, 1, 2),
                             TensorObject(6, 6, 1, 1, 1, 1), TensorObject(6, 0, 100, 100, 100, 100)}) {
    const Expected<TorchTable> table =
        ParseTorchPickle(TorchFile(object, "](" + PickledText("7") + "e", Floats({0, 1, 2, 3, 4, 5})), "t.tar");
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, ErrorCode::kMalformed) << table.error().Message();
  }
}

TEST(TorchPickle, LimitsTensorsThatExpandATinyStorage) {
  TorchLimits limits;
  limits.elements = 100;
  const std::string bytes = TorchFile(TensorObject(1, 0, 100, 100, 0, 0), "](" + PickledText("7") + "e", Floats({1}));
  EXPECT_FALSE(ParseTorchPickle(bytes, "t.tar", limits));
}

TEST(TorchPickle, RejectsAClassThatCouldRunCode) {
  const std::string evil = TorchFile("cposix\nsystem\n" + PickledText("touch evil") + "\x85R");
  ExpectError(ParseTorchPickle(evil, "evil.tar"), ErrorCode::kUnsupported, "evil.tar: byte 61");
  EXPECT_FALSE(std::filesystem::exists("evil"));
}

TEST(TorchPickle, RejectsAnUnknownOpcodeWithItsByte) {
  ExpectError(ParseTorchPickle(TorchFile("\x82\x01"), "t.tar"), ErrorCode::kUnsupported, "t.tar: byte 47");
}

TEST(TorchPickle, ListsScalarsByTheirPath) {
  const Expected<TorchTable> table = ParseTorchPickle(TorchFile("}" + PickledText("a") + "}" + PickledText("b") +
                                                                "J\xff\xff\xff\xff"
                                                                "s"
                                                                "s" +
                                                                PickledText("c") +
                                                                "]K\x05"
                                                                "aG\x3f\xf8" +
                                                                std::string(6, '\0') +
                                                                "a"
                                                                "s" +
                                                                PickledText("name") + PickledText("x") + "s"),
                                                      "t.tar");
  ASSERT_TRUE(table) << table.error().Message();
  EXPECT_EQ(table->numbers.at("a/b"), -1.0);
  EXPECT_EQ(table->numbers.at("c/0"), 5.0);
  EXPECT_EQ(table->numbers.at("c/1"), 1.5);
  EXPECT_EQ(table->texts.at("name"), "x");
}

TEST(TorchPickle, StopsAtRecursiveAndExpandingContainers) {
  EXPECT_FALSE(ParseTorchPickle(TorchFile(std::string("]q\0h\0a", 6)), "cycle.tar"));
  std::string bomb = std::string("]q\0", 3);
  for (char i = 1; i < 40; ++i) {  // each list contains the previous one twice: 2^40 visits
    bomb += std::string("](h") + static_cast<char>(i - 1) + "h" + static_cast<char>(i - 1) + "eq" + i;
  }
  EXPECT_FALSE(ParseTorchPickle(TorchFile(bomb), "bomb.tar"));
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += i == 0 ? ")" : "\x85";
  EXPECT_FALSE(ParseTorchPickle(TorchFile(deep), "deep.tar"));
}

std::string ZipFile(const std::string& object, const std::vector<float>& values) {
  const std::string numbers(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  return WriteStoredZip({{"archive/data.pkl", PickleBytes(object)}, {"archive/data/7", numbers}}, "t.pt").value();
}

TEST(TorchPickle, ReadsTheSameTensorsFromTheZipForm) {
  const Expected<TorchTable> table =
      ParseTorchPickle(ZipFile(TensorObject(6, 0, 2, 3, 1, 2), {0, 1, 2, 3, 4, 5}), "t.pt");
  ASSERT_TRUE(table) << table.error().Message();
  ASSERT_NE(table->Find("w"), nullptr);
  EXPECT_EQ(table->Find("w")->element, "float32");
  EXPECT_EQ(table->Find("w")->values, (std::vector<double>{0, 2, 4, 1, 3, 5}));
}

TEST(TorchPickle, RejectsADamagedZipFormWithItsMember) {
  const std::string object = TensorObject(6, 0, 2, 3, 1, 2);
  ExpectMalformed(ParseTorchPickle("PK\x03\x04zip", "t.pt"), "t.pt");
  ExpectMalformed(ParseTorchPickle(ZipFile(object, {0, 1, 2}), "t.pt"), "t.pt:archive/data/7");
  for (const auto& [member, bytes] : {std::pair{"archive/data.pkl", PickleBytes(object)}, {"a.npy", std::string()}})
    ExpectMalformed(ParseTorchPickle(WriteStoredZip({{member, bytes}}, "t").value(), "t.pt"), "t.pt");
}

TEST(TorchPickle, SurvivesMutatedFiles) {
  const std::string good =
      TorchFile(TensorObject(6, 0, 2, 3, 3, 1), "](" + PickledText("7") + "e", Floats({0, 1, 2, 3, 4, 5}));
  ASSERT_TRUE(ParseTorchPickle(good, "good"));
  Random random(1, "torch_pickle.mutation");
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = good;
    const int changes = 1 + static_cast<int>(random.Below(4));
    for (int i = 0; i < changes; ++i) {
      const std::size_t at = random.Below(bytes.size());
      switch (random.Below(4)) {
        case 0:
          bytes[at] = static_cast<char>(random.Next());
          break;
        case 1:
          bytes.erase(at, 1 + random.Below(8));
          break;
        case 2:
          bytes.insert(at, bytes.substr(random.Below(bytes.size()), random.Below(20)));
          break;
        default:
          bytes.resize(at + 1);
          break;
      }
    }
    const Expected<TorchTable> table = ParseTorchPickle(bytes, "mutant");
    if (!table) {
      ++refused;
      EXPECT_FALSE(table.error().where.empty());
    }
  }
  EXPECT_GT(refused, 10000);
}

TEST(TorchPickle, ReadsPublishedWeights) {
  const char* goldens = std::getenv("MOCURATE_GOLDENS");
  if (goldens == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is not set";
  const Expected<TorchTable> table =
      ReadTorchPickle(std::filesystem::path(goldens) / "published/action_recognition_model_humanact12.tar");
  ASSERT_TRUE(table) << table.error().Message();
  const TorchTensor* weight = table->Find("model/recurrent.weight_ih_l0");
  ASSERT_NE(weight, nullptr);
  EXPECT_EQ(weight->shape, (std::vector<std::int64_t>{384, 72}));
  double sum = 0.0;
  for (const double value : weight->values) sum += value;
  EXPECT_NEAR(sum, 479.57619494272285, 1e-9);
  EXPECT_EQ(table->numbers.at("iteration"), 30000.0);
}

}  // namespace
}  // namespace mocurate
