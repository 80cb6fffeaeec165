// One unit a quantity: people read millimetres and degrees, the run is asked in metres and radians.
const DEG = 180 / Math.PI;
const READ = { m: [1e3, "mm"], rad: [DEG, "deg"], "m/s": [1e3, "mm/s"], "rad/s": [DEG, "deg/s"], "m/s^2": [1e3, "mm/s²"], "rad/s^2": [DEG, "deg/s²"] };

/** { factor, unit }: the unit in which a number of a unit is read, and the factor to it. */
export const readIn = (unit) => { const [factor, read] = READ[unit] || [1, unit || ""]; return { factor, unit: read }; };

/** A key in words: its unit is told beside it. */
export const keyWords = (key) => key.replace(/_(m_per_s|rad_per_s|m_s|rad_s|m_s2|rad_s2|per_s|m|rad|s|hz|px|xyzw)$/, "").replaceAll("_", " ");
