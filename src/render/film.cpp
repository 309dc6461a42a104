// Films by the program ffmpeg: it reads pictures from a socket and writes into the temporary file that is
// renamed in the end.

#include "core/text.hpp"
#include "hyperiso/render.hpp"
#include "io/atomic_file.hpp"
#include "io/parse.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace hyperiso {
namespace {

constexpr int output_of_ffmpeg = 3; // its descriptor

// What follows the input on the command line; nothing for a suffix that is no film's.
std::vector<std::string> encoding_for(const std::string& suffix) {
  if (suffix == ".mp4")
    return {"-c:v",
            "libx264",
            "-preset",
            "medium",
            "-crf",
            "18",
            "-vf",
            "scale=out_color_matrix=bt709",
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-movflags",
            "+faststart",
            "-f",
            "mp4"};
  if (suffix == ".gif")
    return {"-filter_complex",
            "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=bayer:bayer_scale=4",
            "-loop",
            "0",
            "-f",
            "gif"};
  return {};
}

std::vector<std::string> command_line(const std::vector<std::string>& encoding, int width, int height,
                                      double frames_per_second) {
  std::vector<std::string> words{"ffmpeg",    "-hide_banner",
                                 "-loglevel", "error",
                                 "-f",        "rawvideo",
                                 "-pix_fmt",  "rgb24",
                                 "-s",        text(width, "x", height),
                                 "-r",        text(frames_per_second),
                                 "-i",        "pipe:0",
                                 "-an"};
  words.insert(words.end(), encoding.begin(), encoding.end());
  for (const char* word : {"-y", "/dev/fd/3"}) words.emplace_back(word);
  return words;
}

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept { return std::swap(number_, other.number_), *this; }
  ~Descriptor() { close(); }
  void close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }
  int number() const { return number_; }

 private:
  int number_;
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

} // namespace

struct FilmWriter::State {
  State(std::filesystem::path path_, AtomicFile file_) : path(std::move(path_)), file(std::move(file_)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (process < 0) return;
    ::kill(process, SIGKILL);
    (void)wait();
  }

  Error error(const std::string& reason) const {
    return {Code::file_unwritable, text("cannot write ", path.string(), ": ", reason)};
  }

  Status start(std::vector<std::string> words) {
    int ends[2];
    // A socket, since writing to one whose reader has gone can be asked to give an error, not a signal.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return error(std::strerror(errno));
    const Descriptor reader(ends[0]);
    pictures = Descriptor(ends[1]);
    messages.reset(std::tmpfile());
    if (!messages) return error(std::strerror(errno));

    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, reader.number(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ::fileno(messages.get()), STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ::fileno(messages.get()), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, file.descriptor(), output_of_ffmpeg);
    // Of its own group: a Ctrl-C is ours to deal with. It ends when the pictures do.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int problem =
        ::posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (problem == 0) return {};
    process = -1;
    return error(problem == ENOENT
                     ? "films are encoded by the program ffmpeg, which is not on PATH; install it, "
                       "or write .glb, .pvd or numbered .png"
                     : text("ffmpeg: ", std::strerror(problem)));
  }

  // Whether ffmpeg ended well.
  bool wait() {
    pictures.close();
    int status = 0;
    pid_t ended;
    do ended = ::waitpid(process, &status, 0);
    while (ended < 0 && errno == EINTR);
    process = -1;
    return ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  // What ffmpeg said last.
  Error complaint() const {
    std::string said(4096, '\0');
    std::fseek(messages.get(), 0, SEEK_SET);
    said.resize(std::fread(said.data(), 1, said.size(), messages.get()));
    std::string last = "it ended early";
    std::string_view rest = said;
    while (!rest.empty())
      if (const std::string_view line = trimmed(next_line(rest)); !line.empty()) last = line;
    return error("ffmpeg: " + last);
  }

  std::filesystem::path path;
  AtomicFile file;
  Descriptor pictures; // our end
  std::unique_ptr<std::FILE, CloseFile> messages;
  pid_t process = -1;
};

FilmWriter::FilmWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
FilmWriter::FilmWriter(FilmWriter&&) noexcept = default;
FilmWriter::~FilmWriter() = default;

Result<FilmWriter> FilmWriter::create(const std::filesystem::path& path, int width, int height,
                                      double frames_per_second) {
  const auto encoding = encoding_for(lower_case(path.extension().string()));
  if (encoding.empty())
    return Error{Code::file_unsupported, text(path.string(), ": a film is an .mp4 or a .gif")};
  const bool halves_colours = encoding.back() == "mp4"; // two pixels share one
  if (halves_colours && (width % 2 != 0 || height % 2 != 0))
    return Error{Code::invalid_argument,
                 text("an .mp4 of ", width, "x", height, " pixels: both must be even, as in ",
                      width + width % 2, "x", height + height % 2)};
  if (!(frames_per_second > 0) || !(frames_per_second <= 1000))
    return Error{Code::invalid_argument, text(frames_per_second, " frames per second: it is from 0 to 1000")};
  try {
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    auto state = std::make_unique<State>(path, *std::move(file));
    if (const Status started = state->start(command_line(encoding, width, height, frames_per_second));
        !started)
      return started.error();
    return FilmWriter(std::move(state));
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

Status FilmWriter::add(const Image& image) {
  const std::uint8_t* rest = image.pixels.data();
  std::size_t bytes = image.pixels.size();
  while (bytes > 0) {
    const ssize_t sent = ::send(state_->pictures.number(), rest, bytes, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      (void)state_->wait();
      return state_->complaint();
    }
    rest += sent;
    bytes -= static_cast<std::size_t>(sent);
  }
  return {};
}

Status FilmWriter::finish() {
  if (!state_->wait()) return state_->complaint();
  return state_->file.commit();
}

} // namespace hyperiso
