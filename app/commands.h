#pragma once

#include <CLI/App.hpp>
#include <functional>

#include "job/verbs/verbs.h"

namespace mocurate {

/// Each function adds a subcommand with its options and help; parsing it sets `verb`.
void AddRun(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddPlan(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddJobs(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddFit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddRig(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddExport(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddGenerate(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddDraw(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddReproduce(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddEval(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddAudit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddReview(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddSurvey(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddDataset(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddInspect(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddSynthesize(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddConfig(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddDoctor(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);
void AddCache(CLI::App& app, CommonArguments& common, std::function<Status()>& verb);

}  // namespace mocurate
