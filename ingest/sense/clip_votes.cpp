#include "ingest/sense/clip_votes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/text.h"
#include "ingest/sense/file_names.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kMostOfThem = 0.6;  // share of names of one form, above which the others are another source's

}  // namespace

std::string TwoDecimals(double value) { return FormatDouble(std::round(value * 100.0) / 100.0); }

ClipVotes::ClipVotes(const Json& inspection, std::string format) : format_(std::move(format)) {
  std::map<std::string, std::vector<const Json*>> by_joints;
  std::set<std::string> no_bodies;
  for (const Json& finding : inspection.at("findings")) {
    if (finding.at("code") == "not_joint_positions") no_bodies.insert(finding.at("where").get<std::string>());
  }
  // Features beside joints ("_vecs.npy") may be more, but they are no clips.
  const auto is_body = [&](const Json& clip) { return no_bodies.count(clip.at("id").get<std::string>()) == 0; };
  const bool some = std::any_of(inspection.at("clips").begin(), inspection.at("clips").end(),
                                [&](const Json& clip) { return clip.at("format") == format_ && is_body(clip); });
  for (const Json& clip : inspection.at("clips")) {
    if (some && clip.at("format") == format_ && !is_body(clip)) {
      others_[format_ + " without joint positions"] += 1;
      continue;
    }
    if (clip.at("format") == format_)
      by_joints[clip.at("joints").at("value").dump()].push_back(&clip);
    else
      others_[clip.at("format")] += 1;
  }
  std::size_t most = 0;
  for (const auto& [joints, clips] : by_joints) {
    const bool known = joints != "null";
    if (clips_.empty() || (known && clips.size() > most)) clips_ = clips;
    if (known) most = std::max(most, clips.size());
  }
  // An .amc without its skeleton has no count of joints; its name is of the source all the same.
  if (by_joints.count("null") != 0 && most > 0) {
    clips_.insert(clips_.end(), by_joints["null"].begin(), by_joints["null"].end());
    by_joints.erase("null");
  }
  KeepOneForm();
  for (const auto& [joints, clips] : by_joints) {
    if (!clips_.empty() && clips_[0]->at("joints").at("value").dump() != joints)
      others_[format_ + " of " + joints + " joints"] += clips.size();
  }
  for (const Json& clip : inspection.at("clips")) {
    if (std::find(clips_.begin(), clips_.end(), &clip) == clips_.end()) other_files_.push_back(clip.at("file"));
  }
}

/// Companions of other names (KARD's pixels beside its places) are not of the source.
void ClipVotes::KeepOneForm() {
  std::map<std::string, std::size_t> forms;
  for (const Json* clip : clips_) forms[FormOf(clip->at("file"))] += 1;
  const auto most =
      std::max_element(forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (forms.size() < 2 || static_cast<double>(most->second) < kMostOfThem * static_cast<double>(clips_.size())) return;
  std::vector<const Json*> kept;
  for (const Json* clip : clips_) {
    if (FormOf(clip->at("file")) == most->first)
      kept.push_back(clip);
    else
      others_[format_ + " of other names"] += 1;
  }
  clips_ = std::move(kept);
}

/// The most frequent value, weighted by how sure; the comment says where it comes from.
Vote ClipVotes::Ask(const char* field) const {
  std::map<std::string, double> weights;
  std::map<std::string, std::size_t> counts;
  double all = 0.0;
  for (const Json* clip : clips_) {
    const Json& said = clip->at(field);
    if (said.at("value").is_null()) continue;
    const double weight = std::max(1e-6, said.at("confidence").get<double>());
    weights[said.at("value").dump()] += weight;
    counts[said.at("value").dump()] += 1;
    all += weight;
  }
  Vote vote;
  if (weights.empty()) {
    vote.from = "unknown";
    vote.comment = clips_.empty() ? "" : clips_[0]->at(field).value("evidence", "");
    return vote;
  }
  const auto most = std::max_element(weights.begin(), weights.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const Json* clearest = nullptr;
  for (const Json* clip : clips_) {
    const Json& said = clip->at(field);
    if (said.at("value").dump() != most->first) continue;
    if (clearest == nullptr || said.at("confidence") > clearest->at("confidence")) clearest = &said;
  }
  vote.value = clearest->at("value");
  vote.from = clearest->at("from");
  vote.share = most->second / all;
  vote.voters = static_cast<double>(counts[most->first]) / static_cast<double>(clips_.size());
  const std::string evidence = clearest->value("evidence", "");
  if (vote.from == "declared") {
    vote.comment = "declared by the file: " + evidence;
  } else {
    vote.comment = "measured: " + std::to_string(counts[most->first]) + " of " + std::to_string(clips_.size()) +
                   " clips say so, the clearest " + TwoDecimals(clearest->at("confidence").get<double>()) + " sure (" +
                   evidence + ")";
  }
  return vote;
}

/// The clip that is surest about a field.
const Json& ClipVotes::Surest(const char* field) const {
  const Json* best = clips_.front();
  for (const Json* clip : clips_) {
    if (clip->at(field).at("confidence") > best->at(field).at("confidence")) best = clip;
  }
  return *best;
}

std::vector<std::string> ClipVotes::Facts(const char* key) const {
  std::vector<std::string> facts;
  for (const Json* clip : clips_) {
    facts.push_back(clip->contains("facts") ? clip->at("facts").value(key, "") : "");
  }
  return facts;
}

}  // namespace mocurate
