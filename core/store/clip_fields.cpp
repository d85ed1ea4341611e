#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/store/fields.h"

namespace mocurate::store {
namespace {

std::string ProvenanceText(const std::map<std::string, std::string>& provenance) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [key, value] : provenance) json[DisplayPath(key)] = DisplayPath(value);
  return json.dump();
}

std::map<std::string, std::string> ProvenanceFrom(const std::string& text) {
  std::map<std::string, std::string> provenance;
  const auto json = ParseJson(text, "").value_or(nlohmann::json::object());  // its rule has been checked
  for (const auto& [key, value] : json.items()) provenance[key] = value.get<std::string>();
  return provenance;
}

/// A text field of all clips.
template <class Member>
void PutTexts(const std::vector<const Clip*>& clips, const std::string& path, const Member& member, Content& content) {
  std::vector<std::string> texts;
  for (const Clip* clip : clips) texts.push_back(member(*clip));
  const std::uint64_t rows = texts.size();
  content.Put(path, {rows}, std::move(texts));
}

void PackSegments(const std::vector<const Clip*>& clips, Content& content) {
  std::vector<std::int32_t> rows;
  std::vector<double> begin;
  std::vector<double> end;
  std::vector<std::string> label;
  std::vector<std::string> category;
  std::vector<std::string> origin;
  for (std::size_t row = 0; row < clips.size(); ++row) {
    for (const Segment& segment : clips[row]->segments) {
      rows.push_back(static_cast<std::int32_t>(row));
      begin.push_back(segment.begin_s);
      end.push_back(segment.end_s);
      label.push_back(segment.label);
      category.push_back(segment.category);
      origin.push_back(segment.origin);
    }
  }
  const std::uint64_t S = rows.size();
  content.Put("/segments/clip", {S}, std::move(rows));
  content.Put("/segments/begin_s", {S}, std::move(begin));
  content.Put("/segments/end_s", {S}, std::move(end));
  content.Put("/segments/label", {S}, std::move(label));
  content.Put("/segments/category", {S}, std::move(category));
  content.Put("/segments/origin", {S}, std::move(origin));
}

void UnpackSegments(const Content& content, std::vector<Clip>& clips) {
  if (!content.Has("/segments/clip")) return;
  const auto& rows = content.Values<std::int32_t>("/segments/clip");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    clips.at(static_cast<std::size_t>(rows[i]))
        .segments.push_back(
            {content.Values<double>("/segments/begin_s")[i], content.Values<double>("/segments/end_s")[i],
             content.Values<std::string>("/segments/label")[i], content.Values<std::string>("/segments/category")[i],
             content.Values<std::string>("/segments/origin")[i]});
  }
}

void PackIdentities(const std::vector<const Clip*>& clips, Content& content) {
  PutTexts(
      clips, "/clips/id", [](const Clip& c) { return c.id(); }, content);
  PutTexts(
      clips, "/clips/source", [](const Clip& c) { return c.identity.source; }, content);
  PutTexts(
      clips, "/clips/person", [](const Clip& c) { return c.identity.person; }, content);
  PutTexts(
      clips, "/clips/recording", [](const Clip& c) { return c.identity.recording; }, content);
  PutTexts(
      clips, "/clips/session", [](const Clip& c) { return c.identity.session; }, content);
  PutTexts(
      clips, "/clips/view", [](const Clip& c) { return c.identity.view; }, content);
  PutTexts(
      clips, "/clips/licence", [](const Clip& c) { return c.identity.licence; }, content);
  std::vector<std::int32_t> begin;
  std::vector<std::int32_t> end;
  for (const Clip* clip : clips) {
    begin.push_back(clip->identity.begin_frame);
    end.push_back(clip->identity.end_frame);
  }
  content.Put("/clips/begin_frame", {clips.size()}, std::move(begin));
  content.Put("/clips/end_frame", {clips.size()}, std::move(end));
}

}  // namespace

void AppendTransform(std::vector<double>& values, const RigidTransform& transform) {
  const Quaterniond& q = transform.rotation;
  values.insert(values.end(), {q.w(), q.x(), q.y(), q.z(), transform.translation.x(), transform.translation.y(),
                               transform.translation.z()});
}

RigidTransform TransformFrom(const std::vector<double>& values, std::size_t row) {
  const double* v = values.data() + 7 * row;
  return {Quaterniond(v[0], v[1], v[2], v[3]), Vector3d(v[4], v[5], v[6])};
}

ClipIdentity IdentityOf(const Content& content, std::size_t row) {
  const auto text = [&](const char* name) { return content.Values<std::string>(std::string("/clips/") + name)[row]; };
  ClipIdentity identity;
  identity.source = text("source");
  identity.person = text("person");
  identity.recording = text("recording");
  identity.session = text("session");
  identity.view = text("view");
  identity.licence = text("licence");
  identity.begin_frame = content.Values<std::int32_t>("/clips/begin_frame")[row];
  identity.end_frame = content.Values<std::int32_t>("/clips/end_frame")[row];
  return identity;
}

std::string TextOfRate(const FrameRate& rate) {
  const auto reduced = FrameRate::Parse(rate.Text());
  return reduced ? reduced->Text() : rate.Text();
}

std::string CommonRate(const std::vector<std::string>& rates) {
  if (rates.empty()) return "mixed";
  for (const std::string& rate : rates) {
    if (rate != rates[0]) return "mixed";
  }
  return rates[0];
}

std::string AboutText(const std::vector<const Clip*>& clips) {
  std::set<std::string> origins;
  for (const Clip* clip : clips) {
    const auto noted = clip->provenance.find(kHeightOrigin);
    origins.insert(noted == clip->provenance.end() ? "" : noted->second);
  }
  if (origins.empty() || origins == std::set<std::string>{""}) return "";
  return ProvenanceText({{kHeightOrigin, origins.size() == 1 ? *origins.begin() : "mixed"}});
}

void PackClips(const std::vector<const Clip*>& clips, Content& content) {
  PackIdentities(clips, content);
  PutTexts(
      clips, "/clips/role", [](const Clip& c) { return c.role; }, content);
  PutTexts(
      clips, "/clips/label", [](const Clip& c) { return c.label; }, content);
  if (std::any_of(clips.begin(), clips.end(), [](const Clip* c) { return !c->fine_label.empty(); })) {
    PutTexts(
        clips, "/clips/fine_label", [](const Clip& c) { return c.fine_label; }, content);
  }
  PutTexts(
      clips, "/clips/rate", [](const Clip& c) { return TextOfRate(c.rate); }, content);
  PutTexts(
      clips, "/clips/provenance", [](const Clip& c) { return ProvenanceText(c.provenance); }, content);
  PutTexts(
      clips, "/clips/evidence_sha256", [](const Clip& c) { return c.evidence_sha256; }, content);
  std::vector<double> rms;
  std::vector<double> transforms;
  for (const Clip* clip : clips) {
    rms.push_back(clip->fit_rms);
    AppendTransform(transforms, clip->canonical_from_source);
  }
  content.Put("/clips/fit_rms", {clips.size()}, std::move(rms));
  content.Put("/clips/canonical_from_source", {clips.size(), 7}, std::move(transforms));
  PackSegments(clips, content);
}

std::vector<Clip> UnpackClips(const Content& content) {
  std::vector<Clip> clips(content.fields.at("/clips/id").rows());
  for (std::size_t row = 0; row < clips.size(); ++row) {
    Clip& clip = clips[row];
    clip.identity = IdentityOf(content, row);
    clip.role = content.Values<std::string>("/clips/role")[row];
    clip.label = content.Values<std::string>("/clips/label")[row];
    if (content.Has("/clips/fine_label")) clip.fine_label = content.Values<std::string>("/clips/fine_label")[row];
    clip.rate = *FrameRate::Parse(content.Values<std::string>("/clips/rate")[row]);
    clip.provenance = ProvenanceFrom(content.Values<std::string>("/clips/provenance")[row]);
    clip.evidence_sha256 = content.Values<std::string>("/clips/evidence_sha256")[row];
    clip.fit_rms = content.Values<double>("/clips/fit_rms")[row];
    clip.canonical_from_source = TransformFrom(content.Values<double>("/clips/canonical_from_source"), row);
  }
  UnpackSegments(content, clips);
  return clips;
}

}  // namespace mocurate::store
