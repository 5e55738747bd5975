// gltf_validate.cjs MODULES FILE.glb...: Khronos's validator finds neither errors nor warnings.
'use strict';
const fs = require('fs'), path = require('path');
const [modules, ...files] = process.argv.slice(2);
const validator = require(path.join(path.resolve(modules), 'node_modules', 'gltf-validator'));
(async () => {
  for (const file of files) {
    const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
    if (issues.numErrors + issues.numWarnings === 0) continue;
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings: ${JSON.stringify(issues.messages.slice(0, 3))}`);
    process.exitCode = 1;
  }
})();
