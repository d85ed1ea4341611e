#include "core/formats/depth_sequence.h"

#include "core/formats/json_place.h"
#include "ingest/sense/observe.h"

namespace mocurate {

Expected<std::vector<ObservedClip>> ObserveDepthSequence(std::string_view bytes, const std::string& name) {
  const auto sequence = ParseDepthSequence(bytes, name);
  if (!sequence) return Forward(sequence);
  ObservedClip clip;
  clip.format = "depth_sequence";
  clip.frames = sequence->frames;
  clip.rate_hz = sequence->fps;
  clip.skeleton_evidence = std::to_string(sequence->views.size()) + " depth views, no joints";
  clip.layout_evidence = std::to_string(sequence->views.size()) + " views, " + std::to_string(sequence->labels.size()) +
                         " annotated segments";
  clip.rate_evidence = "fps of the file";
  clip.silence = "depth views, no joints";
  clip.units = "m";
  clip.up = "-y";
  clip.handedness = "right";
  return std::vector<ObservedClip>{std::move(clip)};
}

Expected<std::vector<ObservedClip>> ObserveDepthStill(std::string_view bytes, const std::string& name) {
  const Expected<nlohmann::json> document = ParseJson(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &name};
  const Expected<JsonPlace> views = root.Key("views");
  if (!views) return Forward(views);
  if (!views->value->is_object() || views->value->empty()) return views->Bad("views by name are expected");
  for (const auto& [view, unused] : views->value->items()) {
    const Expected<JsonPlace> place = views->Key(view);
    if (!place) return Forward(place);
    const Expected<JsonPlace> rotation = place->Key("R_p_to_d");
    if (!rotation) return Forward(rotation);
    if (const auto matrix = rotation->Rotation(); !matrix) return Forward(matrix);
    if (const auto t = VectorAt(*place, "t_m"); !t) return Forward(t);
    if (const auto pinhole = NumbersAt(*place, "fx_fy_cx_cy", 4); !pinhole) return Forward(pinhole);
  }
  ObservedClip clip;
  clip.format = "depth_still";
  clip.frames = 1;
  const std::string count = std::to_string(views->value->size());
  clip.layout_evidence = count + " depth views of one moment";
  clip.skeleton_evidence = count + " depth views, no joints";
  clip.silence = "depth views, no joints";
  clip.rate_evidence = "one moment has no rate";
  if (root.Has("frame") && (*document)["frame"].is_string()) {
    const std::string frame = (*document)["frame"];
    clip.facts.emplace_back("frame", frame);
    if (frame.find("metres") != std::string::npos) clip.units = "m";
    if (frame.find("x right, y down, z forward") != std::string::npos) {
      clip.up = "-y";
      clip.handedness = "right";
    }
  }
  return std::vector<ObservedClip>{std::move(clip)};
}

}  // namespace mocurate
