#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/motion/clip.h"
#include "core/store/store.h"

namespace mocurate {

/// Part of each of `clips` rows: 0 train, 1 validation, 2 test, -1 none. Rows of a split may be in any order.
std::vector<int> PartsOf(const Split& split, std::size_t clips);

/// "train", "validation", "test"; "" of no part.
const char* NameOfPart(int part);

/// Replaces each row of the split by its new row; rows whose new row is negative leave the split.
void MoveRows(const std::vector<int>& new_rows, Split& split);

/// {"name", "train", "validation", "test" (counts), "rule", "leak_check"}
nlohmann::json SplitSummary(const Split& split);

/// Rows of a group by the part that they are in.
using RowsByPart = std::map<int, std::vector<std::size_t>>;

/// The groups that are in two parts. Clips whose part is negative, or whose group is empty, do not count.
std::map<std::string, RowsByPart> InTwoParts(const std::vector<int>& parts, const std::vector<std::string>& groups);

/// Text of Split::leak_check: "ok: no person and no equal clip in two parts", or what two parts share although they
/// must not: `groups` (persons, styles, performances), and the number of contents that clips of both have. `what` names
/// the groups, or is empty.
std::string LeakText(const std::string& what, const std::vector<std::string>& groups, std::size_t repeated);

/// The property of a clip that no two parts share: its person, style or performance (with all its cameras and spans;
/// with `sessions_together` a person's session).
std::string GroupOf(SplitBy by, const Clip& clip, bool sessions_together);

/// Identity of the clip's source data, with its span; empty where it is unknown.
std::string SourceContentOf(const Clip& clip);

/// For each clip whether ContentsOf reads its motion: its source data is unknown, or that of another clip too.
std::vector<bool> DistinguishedByMotion(const std::vector<Clip>& clips);

/// The same of each clip; where it is unknown the clip's hash of `motions`, or without one that of its joints. Clips of
/// several people or arrays of one file, which have its data in common, differ where their joints do. `sets`: the
/// dataset that each clip comes from: the same person of one file, fitted otherwise in two of them, is equal.
std::vector<std::string> ContentsOf(const std::vector<Clip>& clips, const std::vector<std::string>& motions = {},
                                    const std::vector<std::size_t>& sets = {});

}  // namespace mocurate
