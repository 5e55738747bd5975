// The program of examples/c in Go, through cgo.
//
//	hello POLICY [bench]
package main

// #cgo LDFLAGS: -lredman
// #include <redman/redman.h>
// #include <stdlib.h>
// #include <time.h>
import "C"

import (
	"fmt"
	"os"
	"runtime"
	"unsafe"
)

// A goroutine that calls redman stays on its OS thread, to which the text of a failure belongs.
func init() { runtime.LockOSThread() }

func fail(text string) {
	fmt.Fprintln(os.Stderr, "hello:", text)
	os.Exit(1)
}

func check(result C.rdm_result) {
	if result != C.RDM_OK {
		fail(C.GoString(C.rdm_last_error()))
	}
}

// Worlds at the start of their first episode, with actions that hold the start pose.
func makePool(task string, numEnvs int, seed uint64) *C.rdm_pool {
	name := C.CString(task)
	defer C.free(unsafe.Pointer(name))
	var config C.rdm_pool_config
	var pool *C.rdm_pool
	check(C.rdm_pool_config_init(&config, C.sizeof_rdm_pool_config))
	config.task = name
	config.num_envs = C.int32_t(numEnvs)
	config.seed = C.uint64_t(seed)
	config.autoreset = C.RDM_AUTORESET_NEXT_STEP // ended worlds rest until the next step
	check(C.rdm_pool_create(&pool, &config))
	check(C.rdm_pool_reset(pool, nil, nil))
	check(C.rdm_pool_baseline(pool, C.RDM_BASELINE_HOLD))
	return pool
}

// 75 steps; without a policy the start pose is held. Return and cost are of world 0, the hash of all states.
func play(policy *C.rdm_policy) (sum, cost float64, hash C.uint64_t) {
	pool := makePool("hand_over_safe_finger", 4, 7)
	defer C.rdm_pool_destroy(pool)
	spec := C.rdm_spec{struct_size: C.sizeof_rdm_spec}
	rows := C.rdm_buffers{struct_size: C.sizeof_rdm_buffers}
	info := C.rdm_policy_info{struct_size: C.sizeof_rdm_policy_info}
	check(C.rdm_pool_get_spec(pool, &spec))
	check(C.rdm_pool_get_buffers(pool, &rows))
	reward, costs := unsafe.Slice(rows.reward, 4), unsafe.Slice(rows.cost, 4*spec.cost_dim)
	var scratch []byte
	if policy != nil {
		check(C.rdm_policy_check(policy, &spec))
		check(C.rdm_policy_get_info(policy, &info))
		scratch = make([]byte, C.rdm_policy_scratch(policy, 4))
	}
	for t := 0; t < 75; t++ {
		if policy != nil && t%int(info.action_repeat) == 0 {
			check(C.rdm_policy_act(policy, rows.obs, 4, nil, rows.action, unsafe.Pointer(&scratch[0]),
				C.size_t(len(scratch))))
		}
		check(C.rdm_pool_step(pool))
		sum += float64(reward[0])
		cost += float64(costs[0])
	}
	check(C.rdm_pool_get_hash(pool, -1, &hash))
	return
}

// CPU seconds of one step of the pool.
func measure(task string, numEnvs, calls int) float64 {
	pool := makePool(task, numEnvs, 0)
	defer C.rdm_pool_destroy(pool)
	for t := 0; t < calls; t++ { // warms up
		check(C.rdm_pool_step(pool))
	}
	start := C.clock()
	for t := 0; t < calls; t++ {
		check(C.rdm_pool_step(pool))
	}
	return float64(C.clock()-start) / C.CLOCKS_PER_SEC / float64(calls)
}

func main() {
	if len(os.Args) < 2 {
		fail("usage: hello POLICY [bench]")
	}
	_, cost, hash := play(nil)
	fmt.Printf("hold cost %.0f hash %016x\n", cost, uint64(hash))
	path := C.CString(os.Args[1])
	defer C.free(unsafe.Pointer(path))
	var policy *C.rdm_policy
	check(C.rdm_policy_read_file(&policy, path))
	defer C.rdm_policy_destroy(policy)
	sum, cost, hash := play(policy)
	fmt.Printf("policy return %.4f cost %.0f hash %016x\n", sum, cost, uint64(hash))
	if len(os.Args) > 2 {
		fmt.Printf("bandit %.0f ns a step\n", 1e9*measure("bandit", 1, 1000000))
		fmt.Printf("hand_over %.0f steps/s of 1 world\n", 1/measure("hand_over_safe_finger", 1, 40000))
		fmt.Printf("hand_over %.0f steps/s of 64 worlds\n", 64/measure("hand_over_safe_finger", 64, 1000))
	}
}
