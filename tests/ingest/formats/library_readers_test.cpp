// Formats read by libraries: libpng, OpenCV storages, libzip, HDF5. For any bytes the answer is a value or an error
// that names the file. A crash of a library ends only its child process.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/base/random.h"
#include "core/body/skinned_body.h"
#include "core/formats/amass.h"
#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "core/store/body_file.h"
#include "tests/ingest/sources.h"
#include "tests/support/child.h"
#include "tests/support/mutation.h"

namespace mocurate {
namespace {

constexpr std::size_t kCuts = 60;
constexpr std::size_t kCopies = 600;

/// Files truncated at kCuts places, then flipped bits, removed or doubled pieces, inserted numbers and brackets.
std::string Damaged(const std::string& whole, std::size_t copy) {
  if (copy < kCuts) return whole.substr(0, whole.size() * copy / kCuts);
  Random random(5, "library readers", std::to_string(copy));
  if (copy % 2 == 0) return test::Mutated(whole, random);
  std::string flipped = whole;
  for (std::uint64_t flips = 1 + random.Below(4); flips > 0; --flips) {
    flipped[random.Below(flipped.size())] ^= static_cast<char>(1 << random.Below(8));
  }
  return flipped;
}

/// `read` returns the error, or nothing for a value. Exit status 3 of a child: the error names no file.
using Read = std::function<std::optional<Error>(const std::string& bytes)>;

void ExpectAnswers(const std::string& whole, const Read& read) {
  ASSERT_FALSE(read(whole)) << read(whole)->Message();
  const test::Children children = test::InChildren(kCopies, 120, [&](std::size_t i) {
    const std::optional<Error> error = read(Damaged(whole, i));
    if (error && error->where.find("damaged") == std::string::npos) ::_exit(3);
  });
  for (const test::Children::Death& death : children.deaths) {
    // A crash is the library's defect; an error without a place is ours.
    EXPECT_NE(death.signal, 0) << "copy " << death.index << ": " << read(Damaged(whole, death.index))->Message();
    EXPECT_NE(death.signal, SIGALRM) << "copy " << death.index;
  }
  EXPECT_LT(children.deaths.size(), kCopies / 20) << "the library crashes on too many files";
  for (std::size_t i = 0; i + 1 < kCuts; ++i) {
    bool dies = false;
    for (const test::Children::Death& death : children.deaths) dies = dies || death.index == i;
    EXPECT_TRUE(dies || read(Damaged(whole, i))) << "truncated at " << i << "/" << kCuts << " it is read";
  }
}

template <class T>
std::optional<Error> ErrorOf(const Expected<T>& read) {
  return read ? std::nullopt : std::optional<Error>(read.error());
}

std::string Encoded(const std::string& ending, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(LibraryReaders, SurviveDamagedDepthImagesAndMasks) {
  cv::Mat depth(48, 64, CV_16UC1);
  cv::randu(depth, 500, 4000);
  ExpectAnswers(Encoded(".png", depth), [](const std::string& b) { return ErrorOf(DecodeDepthPng(b, "damaged.png")); });
  cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(10, 10, 20, 20)) = 255;
  ExpectAnswers(Encoded(".png", mask), [](const std::string& b) { return ErrorOf(DecodePng(b, "damaged.png")); });
}

TEST(LibraryReaders, WriteDepthImagesThatOpenCvReads) {
  DepthImage image{7, 3, {}};
  for (int i = 0; i < 21; ++i) image.values.push_back(static_cast<std::uint16_t>(i * 3119));
  std::string png = EncodePng(image).value();
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8U, png.data());
  const cv::Mat read = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_16UC1);
  ASSERT_EQ(read.size(), cv::Size(7, 3));
  EXPECT_TRUE(std::equal(image.values.begin(), image.values.end(), read.begin<std::uint16_t>()));
}

std::string Storage(const std::string& ending) {
  cv::FileStorage storage(ending, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "intrinsic" << (cv::Mat_<double>(3, 3) << 500, 0, 320, 0, 500, 240, 0, 0, 1);
  storage << "R" << cv::Mat::eye(3, 3, CV_64F) << "t" << (cv::Mat_<double>(3, 1) << 1, 2, 3);
  return storage.releaseAndGetString();
}

TEST(LibraryReaders, SurviveDamagedOpenCvStorages) {
  for (const char* ending : {".xml", ".yml"}) {
    ExpectAnswers(Storage(ending), [](const std::string& b) {
      return ErrorOf(ParseOpenCvCalibration({{"damaged", b}}));
    });
  }
}

TEST(LibraryReaders, SurviveDamagedArrayArchives) {
  Amass amass;
  amass.layout = Amass::Layout::kSplit;
  amass.rate_hz = 120.0;
  amass.gender = "female";
  amass.surface_model = "smplx";
  amass.frames = 3;
  amass.pose_columns = 165;
  amass.poses.assign(495, 0.1);
  amass.translation_m.assign(9, 0.5);
  amass.betas.assign(16, 0.25);
  ExpectAnswers(EncodeAmass(amass, "whole").value(),
                [](const std::string& b) { return ErrorOf(ParseAmass(b, "damaged.npz")); });
}

TEST(LibraryReaders, SurviveADamagedBodyFile) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path folder = FreshFolder("body");
  const std::string whole = ReadFile(TestData() + "/body_cc0/body_cc0.h5").value();
  ExpectAnswers(whole, [&](const std::string& bytes) {
    const std::filesystem::path file = folder / ("damaged" + std::to_string(getpid()) + ".h5");
    Put(file, bytes);
    return ErrorOf(ReadBodyTemplate(file));
  });
}

}  // namespace
}  // namespace mocurate
