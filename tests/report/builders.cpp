#include "tests/report/builders.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/depth_files.h"
#include "tests/support/render_depth.h"

namespace mocurate::test {
namespace {

nlohmann::json Measures(double spread, double jerk, double missing) {
  return {{"frames", 40},       {"bone_spread_mm", spread}, {"jerk", jerk}, {"missing_share", missing},
          {"frozen_frames", 0}, {"foot_skate", 0.1}};
}

nlohmann::json Metrics(const std::string& label) {
  const nlohmann::json metrics = {{"FID_train", {{"value", 0.2}, {"interval", nullptr}, {"interval_kind", nullptr}}}};
  return {{"rows", {{{"name", "Real"}, {"metrics", metrics}}, {{"name", "Action2Motion"}, {"metrics", metrics}}}},
          {"recognisers",
           {{"recogniser",
             {{"test_accuracy", {0.9, 1.0}},
              {"mean", 0.95},
              {"test_clips", 10},
              {"confusion", {{9, 1}, {0, 10}}},
              {"labels", {label, "wave"}}}}}},
          {"nearest_neighbour", {{"split", "s"}, {"accuracy", 0.8}, {"correct", 8}, {"count", 10}}}};
}

/// Summaries of the networks that were trained.
nlohmann::json Training() {
  return {{"Action2Motion/1",
           {{"kind", "action2motion"},
            {"iterations", 300},
            {"batch", 8},
            {"clips", 40},
            {"loss", 0.5},
            {"history",
             {{"step", {1.0, 2.0, 3.0, 4.0}},
              {"loss", {3.0, 2.0, 1.0, 0.5}},
              {"reconstruction", {2.0, 1.5, 0.9, 0.4}},
              {"kl", {1.0, 0.5, 0.1, 0.1}}}}}}};
}

}  // namespace

nlohmann::json FittedClip(const std::string& item, const std::string& label, double residual_mm) {
  return {{"item", item},
          {"kept", true},
          {"ingest", {{"person", "p1"}, {"label", label}, {"frames", 40}, {"missing_share", 0.1}}},
          {"fitting",
           {{"method", "joint_tracks"},
            {"residual_rms_mm", residual_mm},
            {"residual_p95_mm", 2.0 * residual_mm},
            {"iterations", 12},
            {"before", Measures(9.0 + residual_mm, 80.0, 0.1)},
            {"after", Measures(0.0, 20.0, 0.0)}}},
          {"canon", {{"clips", 1}}},
          {"findings",
           {{{"clip", item},
             {"code", "missing_joints"},
             {"severity", "warning"},
             {"message", "9 % of the joints are missing"},
             {"action", "interpolated"}}}}};
}

nlohmann::json FailedClip(const std::string& item, const std::string& message) {
  return {{"item", item},
          {"kept", false},
          {"ingest", nlohmann::json::object()},
          {"fitting", nlohmann::json::object()},
          {"canon", nlohmann::json::object()},
          {"findings", nlohmann::json::array()},
          {"failure", {{"stage", "ingest"}, {"code", "malformed"}, {"message", message}}}};
}

SmallRun::SmallRun(const std::string& label) {
  const SkeletonPtr skeleton = Walker();
  const Motion motion = Stepping(skeleton, 40);
  run = {{"name", "small"},
         {"description", "Three clips of one person."},
         {"takes", "no time"},
         {"created_by", "mocurate test"},
         {"stages",
          {{{"stage", "ingest"}, {"items", 3}, {"done", 3}, {"suspect", 0}, {"refused", 0}, {"crashed", 0}},
           {{"stage", "fitting"}, {"items", 3}, {"done", 2}, {"suspect", 1}, {"refused", 0}, {"crashed", 0}}}},
         {"clips", nlohmann::json::array()},
         {"persons",
          {{"p1",
            {{"person", "p1"},
             {"bone_length_m", {{"left_knee", 0.4}, {"right_knee", 0.4}}},
             {"stature_m", 1.6},
             {"clips", 3}}}}},
         {"audit",
          {{"clips", 3},
           {"frames", 120},
           {"seconds", 4.0},
           {"per_label", {{label, 3}}},
           {"splits",
            {{{"name", "s"},
              {"train", 2},
              {"validation", 0},
              {"test", 1},
              {"rule", "by person"},
              {"leak_check", "ok"}}}}}},
         {"metrics", Metrics(label)},
         {"training", Training()},
         {"fit_error",
          {{"joint_mm", 8.0},
           {"evidence_mm", 30.0},
           {"rotation_deg", 3.0},
           {"bone_direction_deg", 2.0},
           {"frames", 120},
           {"clips", 3}}},
         {"table",
          {{"title", "small"},
           {"rows", std::vector<std::vector<std::string>>{{"method", "FID"}, {"Real", "0.200 ± 0.100"}}},
           {"notes", {"± is explained."}}}}};
  double residual = 5.0;
  for (const char* name : {"a", "b", "c"}) {
    Clip evidence;
    evidence.identity = {"test", "p1", name, "", "", "", 0, 40};
    evidence.label = label;
    evidence.rate = motion.rate;
    evidence.evidence.tracks = NoisyTracks(motion);
    if (std::string(name) == "c") {
      DepthView view;
      view.camera = FrontCamera();
      std::vector<Vector3d> joints;
      for (int j = 0; j < motion.joint_count(); ++j) joints.emplace_back(motion.joints.at(20, j));
      const std::vector<float> depth = RenderDepth(BoneCapsules::Make(skeleton), joints.data(), view.camera);
      DepthImage image{view.camera.width, view.camera.height, {}};
      for (const float metres : depth)
        image.values.push_back(static_cast<std::uint16_t>(std::lround(1000.0F * metres)));
      EXPECT_TRUE(WriteDepthImage(image, folder / "depth.png"));
      view.files.assign(40, "depth/c.png");
      view.sha256.assign(40, std::string(64, '0'));
      for (int f = 0; f < 40; ++f) view.time_s.push_back(motion.rate.FrameTime(f));
      evidence.evidence.depth_views.push_back(view);
    }
    AddClip(std::string("test/p1/") + name, evidence, motion);
    run["clips"].push_back(FittedClip(std::string("test/p1/") + name, label, residual));
    residual += 5.0;
  }
  inputs.push_back({"depth", "depth/c.png", folder / "depth.png", ""});
}

void SmallRun::AddClip(const std::string& item, const Clip& evidence, const Motion& fitted) {
  const std::string name = evidence.identity.recording;
  EXPECT_TRUE(WriteEvidence(evidence, folder / ("evidence_" + name + ".h5")));
  Dataset fit;
  fit.skeleton = fitted.skeleton;
  fit.created_by = "mocurate test";
  Clip clip = evidence;
  clip.evidence = Evidence();
  clip.motion = fitted;
  fit.clips.push_back(clip);
  const Status written = WriteDataset(fit, folder / ("fit_" + name + ".h5"));
  EXPECT_TRUE(written) << written.error().Message();
  inputs.push_back({"evidence", item, folder / ("evidence_" + name + ".h5"), ""});
  inputs.push_back({"fit", item, folder / ("fit_" + name + ".h5"), ""});
}

StageRequest SmallRun::Request(const std::string& output) const {
  StageRequest request;
  request.stage = "report";
  request.item = "report";
  request.options = OptionsToJson(ReportOptions());
  request.inputs = inputs;
  request.inputs.push_back({"run", "run.json", folder / "run.json", ""});
  request.output = folder / output;
  return request;
}

Expected<std::string> SmallRun::Page(const std::string& output) {
  if (Status written = WriteFile(folder / "run.json", run.dump()); !written) return Forward(written);
  const auto outcome = ReportStage(Request(output));
  if (!outcome) return Forward(outcome);
  return ReadFile(folder / output);
}

}  // namespace mocurate::test
