#pragma once

#include <map>
#include <string>
#include <vector>

#include "ingest/inspect/inspection.h"

namespace mocurate {

/// What the clips of a source report of one thing.
template <class T>
struct Vote : Pooled<T> {
  double voters = 0.0;  ///< share of the clips that report this
  std::string comment;
};

/// The clips of an inspection that one source could be, asked together: of one format, of the most frequent count of
/// joints (or of none, where a file does not declare it), with names of one form where most have one. Of arrays those
/// that are bodies, where some are. The inspection must outlive it.
class ClipConsensus {
 public:
  ClipConsensus(const Inspection& inspection, std::string format);

  const std::vector<const InspectedClip*>& clips() const { return clips_; }
  /// Of the clips, each once, in their order.
  std::vector<std::string> files() const;
  /// What is excluded, with the number of clips.
  const std::map<std::string, std::size_t>& others() const { return others_; }
  /// Files of other clips, which a pattern must not take.
  const std::vector<std::string>& other_files() const { return other_files_; }
  /// The most frequent value of a field, weighted by confidence; the comment says where it comes from.
  template <class T>
  Vote<T> Ask(Reported<T> InspectedClip::*field) const;
  /// The clip whose skeleton is the most certain.
  const InspectedClip& ClearestSkeleton() const;
  /// One of the facts, of every clip; empty where it has none.
  std::vector<std::string> Facts(const char* key) const;

 private:
  void KeepOneForm();

  std::string format_;
  std::vector<const InspectedClip*> clips_;
  std::map<std::string, std::size_t> others_;
  std::vector<std::string> other_files_;
};

/// "0.93", as a declaration says how sure it is.
std::string TwoDecimals(double value);

/// Fills `groups`: clips of one folder, format and joint count together. Rates that enough motions of a folder deny are
/// "rate_suspect" of the folder (RateDenials).
void CompareGroups(Inspection& inspection);

}  // namespace mocurate
