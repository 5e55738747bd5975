# The program of examples/c in Ruby: Fiddle is told what the stable headers say.
#
#   ruby hello.rb POLICY [bench]
#
# REDMAN_INCLUDE (the folder of the headers) and REDMAN_LIBRARY say where they are, when not where they were installed.
require 'fiddle/import'

# Constants, structs and functions by the header's names: Redman::RDM_OK, Redman::Rdm_spec, Redman.rdm_pool_step.
module Redman
  extend Fiddle::Importer
  dlload ENV.fetch('REDMAN_LIBRARY', 'libredman.so.1')
  extern 'long clock()' # CPU time of the process, us
  typealias 'rdm_result', 'int32_t'
  folder = ENV.fetch('REDMAN_INCLUDE', '/usr/local/include/redman')
  header = %w[base policy pool agent].map { |name| File.read("#{folder}/#{name}.h") }.join("\n").gsub(%r{/\*.*?\*/}m, '')
  header.scan(/^#define (RDM_\w+) +(\d+)/) { |name, value| const_set(name, value.to_i) }
  header.scan(/\benum \w*\s*{([^}]*)}/) do |list,|
    list.scan(/(\w+)(?:\s*=\s*(-?\d+))?/).reduce(0) { |n, (name, value)| const_set(name, (value || n).to_i) + 1 }
  end
  header.scan(/typedef struct \w+ {([^}]*)} (\w+);/) do |body, name|
    body = body.gsub(/[\w *]+\(\*(\w+)\)[^;]*/, 'void *\1').gsub('const ', '').gsub(/RDM_\w+/) { |n| const_get(n) }
    members = body.scan(/(\w+) ([^;]*);/).flat_map { |type, names| names.split(/, */).map { |one| "#{type} #{one}" } }
    const_set(name.capitalize, struct(members))
  end
  header.scan(/^RDM_API ([^;]*);/) { |text,| extern text.gsub(/\bconst /, '').gsub(/\s+/, ' ') }

  def self.check(result)
    raise rdm_last_error.to_s unless result == RDM_OK
  end

  # A struct filled by the block.
  def self.filled(type)
    value = type.malloc(Fiddle::RUBY_FREE)
    value.struct_size = type.size
    check yield(value)
    value
  end

  # A handle, or a number, that the block writes.
  def self.written
    bytes = "\0" * 8
    check yield(bytes)
    bytes.unpack1('Q')
  end
end

# Worlds at the start of their first episode, with actions that hold the start pose.
def make_pool(task, num_envs, seed)
  config = Redman.filled(Redman::Rdm_pool_config) { |c| Redman.rdm_pool_config_init(c, c.class.size) }
  config.task = task # the argument keeps the string until the pool has its copy
  config.num_envs = num_envs
  config.seed = seed
  config.autoreset = Redman::RDM_AUTORESET_NEXT_STEP # ended worlds rest until the next step
  pool = Redman.written { |out| Redman.rdm_pool_create(out, config) }
  Redman.check Redman.rdm_pool_reset(pool, nil, nil)
  Redman.check Redman.rdm_pool_baseline(pool, Redman::RDM_BASELINE_HOLD)
  pool
end

# 75 steps; without a policy the start pose is held. Return and cost are of world 0, the hash of all states.
def play(policy)
  pool = make_pool('hand_over_safe_finger', 4, 7)
  spec = Redman.filled(Redman::Rdm_spec) { |s| Redman.rdm_pool_get_spec(pool, s) }
  rows = Redman.filled(Redman::Rdm_buffers) { |b| Redman.rdm_pool_get_buffers(pool, b) }
  if policy
    Redman.check Redman.rdm_policy_check(policy, spec)
    repeat = Redman.filled(Redman::Rdm_policy_info) { |i| Redman.rdm_policy_get_info(policy, i) }.action_repeat
    scratch = "\0" * Redman.rdm_policy_scratch(policy, 4)
  end
  sum = cost = 0.0
  75.times do |t|
    if policy && (t % repeat).zero?
      Redman.check Redman.rdm_policy_act(policy, rows.obs, 4, nil, rows.action, scratch, scratch.bytesize)
    end
    Redman.check Redman.rdm_pool_step(pool)
    sum += rows.reward[0, 4].unpack1('f')
    cost += rows.cost[0, 4].unpack1('f')
  end
  hash = Redman.written { |out| Redman.rdm_pool_get_hash(pool, -1, out) }
  Redman.rdm_pool_destroy(pool)
  [sum, cost, hash]
end

# CPU seconds of one step of the pool.
def measure(task, num_envs, calls)
  pool = make_pool(task, num_envs, 0)
  calls.times { Redman.check Redman.rdm_pool_step(pool) } # warms up
  start = Redman.clock
  calls.times { Redman.check Redman.rdm_pool_step(pool) }
  seconds = (Redman.clock - start) * 1e-6
  Redman.rdm_pool_destroy(pool)
  seconds / calls
end

begin
  path, bench = ARGV
  raise 'usage: hello.rb POLICY [bench]' unless path

  _, cost, hash = play(nil)
  puts format('hold cost %.0f hash %016x', cost, hash)
  policy = Redman.written { |out| Redman.rdm_policy_read_file(out, path) }
  sum, cost, hash = play(policy)
  puts format('policy return %.4f cost %.0f hash %016x', sum, cost, hash)
  Redman.rdm_policy_destroy(policy)
  if bench
    puts format('bandit %.0f ns a step', 1e9 * measure('bandit', 1, 1_000_000))
    puts format('hand_over %.0f steps/s of 1 world', 1 / measure('hand_over_safe_finger', 1, 40_000))
    puts format('hand_over %.0f steps/s of 64 worlds', 64 / measure('hand_over_safe_finger', 64, 1000))
  end
rescue StandardError => e
  abort "hello: #{e.message}"
end
