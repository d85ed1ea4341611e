#pragma once

#include "core/base/options.h"

namespace mocurate {

enum class Loss { kMse, kHuber };

struct JointOptions {
  std::string name = "hip";
  double weight = 1.0;
  void Declare(OptionVisitor& v) {
    v.Text("name", name, "joint");
    v.Number("weight", weight, Unit::kNone, {0.0, 100.0}, "how much it counts");
  }
};

struct TrimOptions {
  bool enabled = true;
  double still_speed = 0.05;
  void Declare(OptionVisitor& v) {
    v.Bool("enabled", enabled, "cut still frames | from both ends");
    v.Number("still_speed", still_speed, Unit::kMetrePerSecond, {0.0, 10.0}, "joints slower than this are still");
  }
};

/// One option of every type.
struct SampleOptions {
  std::int64_t seed = 7;
  double height = 1.7;
  double angle = 0.5;
  double step = 0.1;
  double rate = 30.0;
  double size = 1000.0;
  double share = 0.5;
  std::optional<double> limit;
  std::string title = "sample";
  std::filesystem::path path;
  std::vector<double> offsets = {0.0, 1.0};
  std::vector<std::string> people;
  std::map<std::string, std::string> labels;
  Loss loss = Loss::kMse;
  TrimOptions trim;
  std::vector<JointOptions> joints = {{"knee", 3.0}};

  void Declare(OptionVisitor& v) {
    v.Integer("seed", seed, {0.0, 1000.0}, "of all random numbers");
    v.Number("height", height, Unit::kMetre, {0.5, 2.5}, "of the person");
    v.Number("angle", angle, Unit::kRadian, {-3.2, 3.2}, "of the camera");
    v.Number("step", step, Unit::kSecond, {0.0, std::nullopt}, "between frames");
    v.Number("rate", rate, Unit::kHertz, {1.0, 1000.0}, "of the frames");
    v.Number("size", size, Unit::kByte, {}, "of a block");
    v.Number("share", share, Unit::kNone, {0.0, 1.0}, "of the clips");
    v.OptionalNumber("limit", limit, Unit::kMetre, {std::nullopt, 5.0}, "none by default");
    v.Text("title", title, "of the run");
    v.Path("path", path, "of the data");
    v.Numbers("offsets", offsets, Unit::kMetre, {-1.0, 1.0}, "per axis");
    v.Texts("people", people, "who takes part");
    v.TextMap("labels", labels, "code to label");
    v.Choice("loss", loss, {{"mse", Loss::kMse}, {"huber", Loss::kHuber}}, "what is minimised");
    v.Group("trim", trim, "trimming");
    v.List("joints", joints, "joints that count");
  }
};

}  // namespace mocurate
