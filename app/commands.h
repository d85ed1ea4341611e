#pragma once

#include <CLI/App.hpp>
#include <functional>

#include "app/verbs.h"

namespace mocurate {

/// Each adds a subcommand with its options and help; parsing it sets `verb`.
void AddAudit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddReview(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddSurvey(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddDraw(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddReproduce(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddDataset(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);

}  // namespace mocurate
