// Service: the interface of `snug ui`, version 1: requests of a page answered by a folder and its runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/serve/api_server.hpp"
#include "snug/workspace/folder.hpp"
#include "snug/workspace/runs.hpp"

namespace snug::workspace {

/// A scenario to begin with.
struct Template {
  std::string name;
  std::string description;
  std::filesystem::path file;
};

struct ServiceSettings {
  std::filesystem::path folder;
  std::filesystem::path program;  ///< the file of snug
  std::string version;
  std::vector<Template> templates;
  int runs_at_once = 1;
};

/// Addresses and answers: docs/ui-interface.md.
class Service {
 public:
  /// Throws InputError where there is no folder.
  explicit Service(const ServiceSettings& settings);

  /// For any request, however wrong; throws nothing but what the system lacks memory for. From any thread.
  [[nodiscard]] serve::ApiAnswer answer(const serve::ApiRequest& request);

 private:
  [[nodiscard]] serve::ApiAnswer route(const serve::ApiRequest& request);
  [[nodiscard]] serve::ApiAnswer answer_folder();
  [[nodiscard]] serve::ApiAnswer answer_file(const serve::ApiRequest& request, const std::string& name);
  [[nodiscard]] serve::ApiAnswer answer_check(const std::string& name, const std::string& text);
  [[nodiscard]] model::Scenario read_cell(const std::string& name, const std::string& text) const;
  [[nodiscard]] serve::ApiAnswer answer_scene(const std::string& name, const std::string& text) const;
  [[nodiscard]] serve::ApiAnswer answer_reach(const std::string& name, const std::string& text) const;
  [[nodiscard]] static serve::ApiAnswer answer_typical(const std::string& body);
  [[nodiscard]] serve::ApiAnswer answer_sheet(const std::string& name, const std::string& body) const;
  [[nodiscard]] serve::ApiAnswer answer_move(const std::string& name, const std::string& body) const;
  [[nodiscard]] serve::ApiAnswer answer_edit(const std::string& what, const std::string& name,
                                             const std::string& body) const;
  [[nodiscard]] serve::ApiAnswer answer_run(const serve::ApiRequest& request, const std::string& name,
                                            const std::string& part);
  [[nodiscard]] serve::ApiAnswer start_runs(const std::string& body, bool starts);
  [[nodiscard]] serve::ApiAnswer watch(const std::string& name);
  [[nodiscard]] serve::ApiAnswer watch_frames(const std::string& name);

  const ServiceSettings settings_;
  const Folder folder_;
  Runs runs_;
};

}  // namespace snug::workspace
