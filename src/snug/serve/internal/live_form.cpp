// LiveForm: frames and events of a run that goes on, as watchers are told of them: server-sent events.
#include "snug/serve/internal/live_form.hpp"

#include <nlohmann/json.hpp>

#include "snug/core/base64.hpp"
#include "snug/replay/replay.hpp"

namespace snug::serve::internal {

std::string server_event(const char* name, const std::string& data) {
  return std::string("event: ") + name + "\ndata: " + data + "\n\n";
}

std::string header_data(const std::string& name, const record::RecordingHeader& header, const record::Frame& first) {
  replay::FrameCoder still(header);
  still.set_static(first);
  return base64(replay::encode_form(replay::make_header_json({name, &header, {}, "", false, 0}), still.finish()));
}

std::string frames_data(replay::FrameCoder& coder, const std::vector<record::Event>& events) {
  using OrderedJson = nlohmann::ordered_json;
  OrderedJson list = OrderedJson::array();
  for (const record::Event& event : events) {
    OrderedJson numbers = OrderedJson::object();
    for (const record::EventNumber& number : event.numbers) numbers[number.name] = number.value;
    list.push_back({{"time", event.time},
                    {"kind", event.kind},
                    {"body", event.body},
                    {"text", event.text},
                    {"numbers", std::move(numbers)}});
  }
  const OrderedJson header = {{"format", "snug replay"},
                              {"version", replay::kReplayVersion},
                              {"frames", coder.frames()},
                              {"events", std::move(list)}};
  const std::string text = header.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  return base64(replay::encode_form(text, coder.finish()));
}

}  // namespace snug::serve::internal
