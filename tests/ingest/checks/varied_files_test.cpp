// Recorded files with other units, exchanged or mirrored axes, fewer frames or missing joints. The inspection must be
// right or report unknown, never wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "core/base/random.h"
#include "core/formats/bvh.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct TableSet {
  const char* folder;
  std::size_t joints, columns;
  const char* units;
  bool left;
};
const std::array<TableSet, 4> kTables = {
    TableSet{"kinect/kard", 15, 3, "mm", true}, TableSet{"kinect/msr_action3d", 20, 4, "m", false},
    TableSet{"kinect/utkinect", 20, 3, "m", false}, TableSet{"kinect/florence3d", 15, 3, "mm", false}};

const std::map<std::string, double> kMetres = {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}};

/// Axes x, y, z of the changed file: index and sign of the recorded axis.
struct AxisChange {
  std::array<int, 3> axis{0, 1, 2};
  std::array<double, 3> sign{1.0, 1.0, 1.0};

  bool mirrors() const {
    const bool odd = (axis[0] + 1) % 3 != axis[1];
    return (sign[0] * sign[1] * sign[2] < 0.0) != odd;
  }
  std::string Up() const {
    for (int i = 0; i < 3; ++i) {
      if (axis[static_cast<std::size_t>(i)] == 1) {
        return (sign[static_cast<std::size_t>(i)] > 0.0 ? "+" : "-") + std::string(1, static_cast<char>('x' + i));
      }
    }
    return "";
  }
};

struct Change {
  std::string name;
  std::string units;  ///< empty: unchanged
  AxisChange axes;
  std::size_t most_frames = 1000000;
  std::size_t step = 1;
  std::size_t missing = 0;  ///< joints that are zero in every frame
};

std::vector<Change> ChangesOf(Random& random) {
  std::vector<Change> changes = {{"as recorded", "", {}},        {"in cm", "cm", {}},
                                 {"in inches", "inch", {}},      {"mirrored", "", {{0, 1, 2}, {-1.0, 1.0, 1.0}}},
                                 {"every second frame", "", {}}, {"ten frames", "", {}},
                                 {"three frames", "", {}},       {"joints missing", "", {}}};
  changes[4].step = 2;
  changes[5].most_frames = 10;
  changes[6].most_frames = 3;
  changes[7].missing = 2;
  for (int i = 0; i < 3; ++i) {
    Change rotated{"turned", i == 0 ? "" : "m", {}};
    for (std::size_t k = 2; k > 0; --k) std::swap(rotated.axes.axis[k], rotated.axes.axis[random.Below(k + 1)]);
    for (double& sign : rotated.axes.sign) sign = random.Uniform() < 0.5 ? -1.0 : 1.0;
    if (i == 2) rotated.most_frames = 10;
    changes.push_back(rotated);
  }
  return changes;
}

std::string Changed(const std::string& text, const TableSet& set, const Change& change, Random& random) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (double value = 0.0; in >> value;) numbers.push_back(value);
  const std::size_t row = set.columns, frame = set.joints * row, frames = numbers.size() / frame;
  const double scale = change.units.empty() ? 1.0 : kMetres.at(set.units) / kMetres.at(change.units);
  std::vector<bool> gone(set.joints, false);
  for (std::size_t i = 0; i < change.missing; ++i) gone[random.Below(set.joints)] = true;
  std::ostringstream out;
  out.precision(9);
  for (std::size_t f = 0, written = 0; f < frames && written < change.most_frames; f += change.step, ++written) {
    for (std::size_t k = 0; k < set.joints; ++k) {
      const double* at = &numbers[f * frame + k * row];
      for (std::size_t i = 0; i < row; ++i) {
        const double value =
            i < 3 ? change.axes.sign[i] * scale * at[static_cast<std::size_t>(change.axes.axis[i])] : at[i];
        out << (i > 0 ? " " : "") << (gone[k] ? 0.0 : value);
      }
      out << "\n";
    }
  }
  return out.str();
}

class VariedFiles : public WrittenFormats {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }

  /// About `wanted` evenly spaced files of a set.
  static std::vector<fs::path> FilesOf(const std::string& folder, const std::string& ending, std::size_t wanted) {
    std::vector<fs::path> files, chosen;
    for (const auto& entry : fs::directory_iterator(fs::path(std::getenv("MOCURATE_DATA")) / folder)) {
      if (entry.is_regular_file() && entry.path().extension() == ending) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    const std::size_t step = std::max<std::size_t>(1, files.size() / wanted);
    for (std::size_t i = step / 2; i < files.size(); i += step) chosen.push_back(files[i]);
    return chosen;
  }

  void CheckAnswers(const Json& inspection, const std::string& what, const Json& units, const Json& up,
                    const Json& handedness) {
    for (const Json& clip : inspection.at("clips")) {
      for (const auto& [field, truth] :
           std::map<std::string, Json>{{"units", units}, {"up", up}, {"handedness", handedness}}) {
        const Json value = Value(clip, field.c_str());
        ++asked;
        if (value.is_null()) continue;
        ++reported;
        EXPECT_EQ(value, truth) << what << " " << clip.at("id") << " " << field << ": " << clip.at(field).dump();
      }
    }
  }

  int asked = 0, reported = 0;
};

TEST_F(VariedFiles, OfTablesHaveNoWrongAnswerAloneOrInAFolder) {
  Random random(17, "varied", "");
  for (const TableSet& set : kTables) {
    const std::vector<fs::path> files = FilesOf(set.folder, ".txt", 10);
    for (const Change& change : ChangesOf(random)) {
      const std::string name = std::string(set.folder).substr(7) + "_" + std::to_string(random.Below(1000000));
      const Json units = change.units.empty() ? set.units : change.units;
      const Json handedness = set.left != change.axes.mirrors() ? "left" : "right";
      for (const fs::path& file : files) {
        const fs::path written =
            Written(name + "/" + file.filename().string(), Changed(*ReadFile(file), set, change, random));
        CheckAnswers(InspectPath(written, std::nullopt), set.folder + (" " + change.name), units, change.axes.Up(),
                     handedness);
      }
      CheckAnswers(InspectPath(folder_ / name, std::nullopt), set.folder + (" " + change.name) + ", folder", units,
                   change.axes.Up(), handedness);
    }
  }
  EXPECT_GT(reported, 0.75 * asked) << "of " << asked;
}

TEST_F(VariedFiles, OfBvhHaveNoWrongAnswer) {
  std::vector<fs::path> files = FilesOf("bvh/bandai2", ".bvh", 6);
  for (const fs::path& file : FilesOf("bvh/bandai1", ".bvh", 5)) files.push_back(file);
  for (const fs::path& file : files) {
    const auto bytes = ReadFile(file);
    const auto recorded = ParseBvh(*bytes, file.filename().string());
    ASSERT_TRUE(recorded) << recorded.error().Message();
    for (const auto& [units, metres] : kMetres) {
      for (const bool swapped : {false, true}) {
        for (const bool short_one : {false, true}) {
          Bvh bvh = *recorded;
          const double scale = 0.01 / metres;
          std::size_t column = 0;
          for (BvhJoint& joint : bvh.joints) {
            joint.offset *= scale;
            for (const BvhChannel channel : joint.channels) {
              for (std::size_t at = column; IsPosition(channel) && at < bvh.values.size();
                   at += static_cast<std::size_t>(bvh.channel_count))
                bvh.values[at] *= scale;
              ++column;
            }
            // "Hand_L" becomes "Hand_R" and vice versa.
            std::string& name = joint.name;
            const std::size_t end = name.size();
            if (!swapped || end < 3 || name[end - 2] != '_') continue;
            name[end - 1] = name[end - 1] == 'L' ? 'R' : name[end - 1] == 'R' ? 'L' : name[end - 1];
          }
          if (short_one && bvh.frames > 5) {
            bvh.frames = 5;
            bvh.values.resize(5 * static_cast<std::size_t>(bvh.channel_count));
          }
          const auto text = WriteBvh(bvh);
          CheckAnswers(InspectPath(Written("varied.bvh", text), std::nullopt), file.filename().string(), units, "+y",
                       swapped ? "left" : "right");
        }
      }
    }
  }
  EXPECT_GT(reported, 0.9 * asked) << "of " << asked;
}

TEST_F(VariedFiles, OfSensorsContradictTheirFormatOnce) {
  for (const fs::path& file : FilesOf("ntu", ".skeleton", 4)) {
    const auto bytes = ReadFile(file);
    const auto contradictions = [&](double scale, double x_sign, double y_sign) {
      std::istringstream in(*bytes);
      std::ostringstream out;
      out.precision(9);
      for (std::string line; std::getline(in, line);) {
        std::vector<double> row;
        std::istringstream numbers(line);
        for (double value = 0.0; numbers >> value;) row.push_back(value);
        if (row.size() != 12) {
          out << line << "\n";
          continue;
        }
        row[0] *= scale * x_sign, row[1] *= scale * y_sign, row[2] *= scale;
        for (const double value : row) out << value << " ";
        out << "\n";
      }
      const Json inspection = InspectPath(Written(file.filename().string(), out.str()), std::nullopt);
      std::vector<std::string> codes = Codes(inspection, "error");
      std::sort(codes.begin(), codes.end());
      codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
      EXPECT_LT(Codes(inspection, "warning").size(), 6u) << "only findings that follow from the wrong convention";
      return codes;
    };
    EXPECT_THAT(contradictions(1.0, 1.0, 1.0), ::testing::IsEmpty());
    EXPECT_THAT(contradictions(1.0, -1.0, 1.0), ::testing::ElementsAre("handedness_contradiction"));
    EXPECT_THAT(contradictions(1000.0, 1.0, 1.0), ::testing::ElementsAre("units_contradiction"));
    EXPECT_THAT(contradictions(1.0, -1.0, -1.0), ::testing::ElementsAre("up_contradiction"));
  }
}

}  // namespace
}  // namespace mocurate
