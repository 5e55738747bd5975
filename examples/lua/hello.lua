-- The program of examples/c in Lua: LuaJIT's ffi reads the stable headers themselves.
--
--   luajit hello.lua POLICY [bench]
--
-- REDMAN_INCLUDE (the folder of the headers) and REDMAN_LIBRARY say where they are, when not where they were installed.
local ffi, bit = require "ffi", require "bit"

-- ffi knows no preprocessor: numbers become enums; comments, directives and the braces of extern "C" go.
for _, name in ipairs { "base", "policy", "pool", "agent" } do
  local file = assert(io.open((os.getenv "REDMAN_INCLUDE" or "/usr/local/include/redman") .. "/" .. name .. ".h"))
  local header = file:read "*a":gsub("/%*.-%*/", ""):gsub("#define (RDM_[%w_]+) +(%d+)", "enum { %1 = %2 };")
  file:close()
  ffi.cdef((header:gsub("#[^\n]*", ""):gsub("RDM_API", ""):gsub('extern "C" {', ""):gsub("\n}%s*\n", "\n")))
end
ffi.cdef "long clock(void); // CPU time of the process, us"
local redman = ffi.load(os.getenv "REDMAN_LIBRARY" or "redman")

local function check(result)
  if result ~= redman.RDM_OK then error(ffi.string(redman.rdm_last_error()), 0) end
end

-- A struct of redman's that says its size.
local function sized(name)
  local value = ffi.new(name)
  value.struct_size = ffi.sizeof(value)
  return value
end

-- Worlds at the start of their first episode, with actions that hold the start pose.
local function make_pool(task, num_envs, seed)
  local config, out = ffi.new "rdm_pool_config", ffi.new "rdm_pool *[1]"
  check(redman.rdm_pool_config_init(config, ffi.sizeof(config)))
  config.task = task -- the local variable keeps the string until the pool has its copy
  config.num_envs = num_envs
  config.seed = seed
  config.autoreset = redman.RDM_AUTORESET_NEXT_STEP -- ended worlds rest until the next step
  check(redman.rdm_pool_create(out, config))
  local pool = ffi.gc(out[0], redman.rdm_pool_destroy)
  check(redman.rdm_pool_reset(pool, nil, nil))
  check(redman.rdm_pool_baseline(pool, redman.RDM_BASELINE_HOLD))
  return pool
end

-- 75 steps; without a policy the start pose is held. Return and cost are of world 0, the hash of all states.
local function play(policy)
  local pool = make_pool("hand_over_safe_finger", 4, 7)
  local spec, rows, info = sized "rdm_spec", sized "rdm_buffers", sized "rdm_policy_info"
  check(redman.rdm_pool_get_spec(pool, spec))
  check(redman.rdm_pool_get_buffers(pool, rows))
  local size, scratch
  if policy then
    check(redman.rdm_policy_check(policy, spec))
    check(redman.rdm_policy_get_info(policy, info))
    size = redman.rdm_policy_scratch(policy, 4)
    scratch = ffi.new("char[?]", size)
  end
  local sum, cost, hash = 0, 0, ffi.new "uint64_t[1]"
  for t = 0, 74 do
    if policy and t % info.action_repeat == 0 then
      check(redman.rdm_policy_act(policy, rows.obs, 4, nil, rows.action, scratch, size))
    end
    check(redman.rdm_pool_step(pool))
    sum = sum + rows.reward[0]
    cost = cost + rows.cost[0]
  end
  check(redman.rdm_pool_get_hash(pool, -1, hash))
  return sum, cost, bit.tohex(hash[0])
end

-- CPU seconds of one step of the pool.
local function measure(task, num_envs, calls)
  local pool = make_pool(task, num_envs, 0)
  for _ = 1, calls do check(redman.rdm_pool_step(pool)) end -- warms up
  local start = ffi.C.clock()
  for _ = 1, calls do check(redman.rdm_pool_step(pool)) end
  return tonumber(ffi.C.clock() - start) * 1e-6 / calls
end

local function main(path, bench)
  if not path then error("usage: hello.lua POLICY [bench]", 0) end
  local _, cost, hash = play()
  print(("hold cost %.0f hash %s"):format(cost, hash))
  local out, sum = ffi.new "rdm_policy *[1]"
  check(redman.rdm_policy_read_file(out, path))
  sum, cost, hash = play(ffi.gc(out[0], redman.rdm_policy_destroy))
  print(("policy return %.4f cost %.0f hash %s"):format(sum, cost, hash))
  if bench then
    print(("bandit %.0f ns a step"):format(1e9 * measure("bandit", 1, 1000000)))
    print(("hand_over %.0f steps/s of 1 world"):format(1 / measure("hand_over_safe_finger", 1, 40000)))
    print(("hand_over %.0f steps/s of 64 worlds"):format(64 / measure("hand_over_safe_finger", 64, 1000)))
  end
end

local good, text = pcall(main, ...)
if not good then
  io.stderr:write("hello: ", tostring(text), "\n")
  os.exit(1)
end
