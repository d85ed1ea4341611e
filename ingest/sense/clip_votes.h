#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mocurate {

/// What the clips of a source say of one thing.
struct Vote {
  nlohmann::json value;  ///< null: unknown
  std::string from;      ///< declared, measured, unknown
  double share = 0.0;    ///< of the votes
  double voters = 0.0;   ///< share of the clips that say this
  std::string comment;
};

/// The clips of an inspection that one source could be, asked together: of one format, of the most frequent count of
/// joints (or of none, where a file does not say it), with names of one form where most have one. Of arrays those that
/// are bodies, where some are. The inspection must outlive it.
class ClipVotes {
 public:
  ClipVotes(const nlohmann::json& inspection, std::string format);

  const std::vector<const nlohmann::json*>& clips() const { return clips_; }
  /// What is left out, with the number of clips.
  const std::map<std::string, std::size_t>& others() const { return others_; }
  /// Files of other clips, which a pattern must not take.
  const std::vector<std::string>& other_files() const { return other_files_; }
  /// The most frequent value of a field, weighted by how sure; the comment says where it comes from.
  Vote Ask(const char* field) const;
  /// The clip that is surest about a field.
  const nlohmann::json& Surest(const char* field) const;
  /// One of the facts, of every clip; empty where it has none.
  std::vector<std::string> Facts(const char* key) const;

 private:
  void KeepOneForm();

  std::string format_;
  std::vector<const nlohmann::json*> clips_;
  std::map<std::string, std::size_t> others_;
  std::vector<std::string> other_files_;
};

/// "0.93", as a declaration says how sure it is.
std::string TwoDecimals(double value);

}  // namespace mocurate
