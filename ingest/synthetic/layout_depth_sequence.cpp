#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"

namespace mocurate {
namespace {

nlohmann::json VectorJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Camera from the rig's frame: x right, y down, z forward, at PHSPD's polarisation camera.
nlohmann::json ViewJson(const Camera& camera) {
  const RigidTransform camera_from_rig = camera.camera_from_world * Inverse(PhspdPolarFromWorld());
  const Matrix3d r = camera_from_rig.rotation.toRotationMatrix();
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(VectorJson(r.row(i)));
  return {{"R_p_to_d", rows},
          {"t_m", VectorJson(camera_from_rig.translation)},
          {"fx_fy_cx_cy", {camera.fx, camera.fy, camera.cx, camera.cy}},
          {"size", {camera.width, camera.height}}};
}

/// The motion frame by frame, in the rig's frame.
nlohmann::json TruthJson(const Actor& actor, const Motion& seen) {
  const Vector3d pelvis = actor.body == nullptr ? Vector3d(Vector3d::Zero()) : actor.rest.joints[0];
  nlohmann::json frames = nlohmann::json::array();
  for (int f = 0; f < seen.frame_count(); ++f) {
    nlohmann::json vectors = nlohmann::json::array(), joints = nlohmann::json::array();
    for (int j = 0; j < seen.joint_count(); ++j) {
      vectors.push_back(VectorJson(LogQuaternion(seen.rotation_at(f, j))));
      joints.push_back(VectorJson(seen.joints.at(f, j)));
    }
    frames.push_back({{"frame", f},
                      {"rotvec24", vectors},
                      {"translation_added", VectorJson(seen.root_translation[f] - pelvis)},
                      {"joints_m", joints}});
  }
  return frames;
}

nlohmann::json LabelsJson(const PlannedSequence& sequence) {
  nlohmann::json labels = nlohmann::json::array();
  int done = 0;
  const auto add = [&](const std::string& action, int begin, int end) {
    if (end > begin) labels.push_back({{"action", action}, {"first", begin}, {"last", end - 1}});
  };
  for (const ScriptedAction& action : sequence.script.actions) {
    add("idle", done, action.begin);
    add(action.action, action.begin, action.end);
    done = action.end;
  }
  add("idle", done, sequence.script.frames);
  return labels;
}

}  // namespace

Status WriteDepthSequenceLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<Camera> rig = RigOf(options.rig, SensorKind::kDepth);
  const RigFaults faults = FaultsOf(options.rig, rig, options.seed);
  for (const Camera& camera : rig) {
    if (camera.distortion.IsZero()) continue;
    return Fail(ErrorCode::kConfig, "camera '" + camera.name + "' has a lens that the layout cannot store", "rig.kind",
                "choose ring or phspd");
  }
  const std::size_t parts = rig.size() + 1;
  return folder.ForEach(parts * actors.size(), [&](std::size_t i) -> Status {
    const Actor& actor = actors[i / parts];
    const PlannedSequence sequence = PlanDepthSequence(options, static_cast<int>(i / parts) + 1);
    const Motion motion = PerformScript(sequence.script, actor.subject, actor.skeleton, FrameRate{kDepthSequenceHz, 1});
    const std::string person = sequence.Person();
    if (i % parts > 0) {
      const std::size_t k = i % parts - 1;
      const Camera& camera = faults.real[k];
      const auto name_of = [&](int f) {
        return "rendered_seq/" + person + "/depth/" + camera.name + "_" + ZeroPadded(f, 4) + ".png";
      };
      return WriteDepthImages(options, actor, DelayBy(motion, faults.clock_s[k]), camera, person + "/" + camera.name,
                              {}, false, name_of, folder);
    }
    const Motion seen = SelectFrames(motion, PhspdPolarFromWorld());
    nlohmann::json document = {{"body", actor.body == nullptr ? "capsules" : "body_cc0"},
                               {"fps", kDepthSequenceHz},
                               {"frames", motion.frame_count()},
                               {"frame", "PHSPD polarisation camera (x right, y down, z forward), metres"},
                               {"floor", "y = " + FormatDouble(PhspdPolarFromWorld().translation.y()) + " m"},
                               {"labels", LabelsJson(sequence)},
                               {"frames_data", TruthJson(actor, seen)}};
    for (const Camera& camera : rig) document["views"][camera.name] = ViewJson(camera);
    folder.AddTruth(person, "rendered_seq/" + person + "/" + person + ".seq_" + person,
                    SelectFrames(seen, HalfRotationAboutX()));
    return folder.Write("rendered_seq/" + person + "/seq_" + person + ".json", document.dump(1) + "\n");
  });
}

}  // namespace mocurate
